/* cwbvh_types.h -- a tree of eight children a node. Their boxes are rounded outwards to a grid of the node, a byte a plane.
 * Shared by builder and traversal.
 *
 * Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs". */
#ifndef CWBVH_TYPES_H
#define CWBVH_TYPES_H

/* 80 B, five 16-byte loads. The same node has 224 B in bvh8.
 *
 * The plane of byte q lies at origin + (CWBVH_BIAS + q) * 2^(e - 127), where e is the axis's byte of `cells`. That is exact in
 * real numbers; no float is computed of it. A kernel makes the float CWBVH_BIAS + q by putting q into the upper mantissa of
 * CWBVH_BIAS: one permutation of bytes instead of a conversion, which is slow on a GPU. Planes lie at least CWBVH_MARGIN cells
 * outside of the boxes that they bound. The difference of the node's origin and the ray's is rounded by up to CWBVH_BIAS *
 * 2^-24 of a cell, or 1/508, on the far side twice.
 *
 * A node's child nodes stand in a row, in the order of their slots, and so do the primitives of its leaves. As in bvh8, a slot
 * tells where in the node its child lies: let s have the signs of the direction in bits 0, 1, 2, for x, y, z; then visiting
 * slot i ^ s for i = 0..7 mostly meets near children before far ones. An empty slot has planes from 255 to 0, and neither a
 * child nor primitives. */
typedef struct cwbvh_node {
    rt_f32 origin[3];
    rt_u32 cells;       /* bits 0..7 exponent of the cell in x, 8..15 in y, 16..23 in z; 24..31: the slots that are nodes */
    rt_u32 first_child; /* the node of the lowest such slot */
    rt_u32 first_leaf;  /* the position in leaf order of the first primitive of the lowest slot that has any */
    rt_u32 primitives;  /* of bits 4 i .. 4 i + 3 as many are set, from the lowest on, as slot i has primitives */
    rt_u32 pad;
    rt_u32 planes[3][4]; /* for x, y, z: lower planes of slots 0..3, of 4..7, upper planes of 0..3, of 4..7; the first in the low byte */
} cwbvh_node;

#define CWBVH_LEAF_MAX 4u
#define CWBVH_BIAS 32768.0f
#define CWBVH_MARGIN (1.0f / 128.0f)
/* The smallest cell for which the steps of a ray are normal numbers, and the largest for which CWBVH_BIAS cells stay below FLT_MAX;
 * what is added to an exponent in `cells`. */
#define CWBVH_LEAST_EXPONENT (-100)
#define CWBVH_MOST_EXPONENT 112
#define CWBVH_EXPONENT_BIAS 127

#define CWBVH_INNER(node) ((node)->cells >> 24)
/* The number of elements of a row before the one with this bit. */
#define CWBVH_RANK(row, bit) popcount((row) & ((bit)-1u))

#if defined(__OPENCL_VERSION__) && defined(RT_LANES) /* kernels of builds have none */

/* Four planes, as CWBVH_BIAS + q. */
#ifdef __NV_CL_C_VERSION
RT_INLINE float cwbvh_plane(uint word, uint selector)
{
    uint bits;
    __asm("prmt.b32 %0, %1, %2, %3;" : "=r"(bits) : "r"(word), "r"(as_uint(CWBVH_BIAS)), "r"(selector));
    return as_float(bits);
}
#define CWBVH_PLANES(word)                                                                                                     \
    (float4)(cwbvh_plane(word, 0x7404u), cwbvh_plane(word, 0x7414u), cwbvh_plane(word, 0x7424u), cwbvh_plane(word, 0x7434u))
#else
#define CWBVH_PLANES(word) (convert_float4(as_uchar4(word)) + (float4)(CWBVH_BIAS))
#endif
/* The side of a cell from its exponent, which is byte `k` of `cells`. */
#define CWBVH_CELL(cells, k) as_float(((cells) >> 8u * (k)&255u) << 23)

#if RT_LANES == 1

#define CWBVH_DONE 0xFFFFFFFFu /* instead of a node: look at the stack */
/* A stack entry: the remaining child nodes of a node. `base` is the first of its child nodes. `slots` has the remaining slots
 * in bits 0..7, the slots of all its nodes in bits 8..15, and in bits 16..31 the upper half of the least entry distance of the
 * remaining ones. */
#define CWBVH_REMAINING(base, slots) ((ulong)(slots) << 32 | (base))

/* Maximum and minimum of floats by their bits as integers: see bvh4_types.h. A NaN, as products of huge coordinates may be, is
 * greatest or least there, so no child is missed. */
#define CWBVH_MAX(a, b) as_float4(max(as_int4(a), as_int4(b)))
#define CWBVH_MIN(a, b) as_float4(min(as_int4(a), as_int4(b)))

/* The slots on the near side of the node, in z, in y and in x. */
typedef struct cwbvh_order {
    uint z, y, x;
} cwbvh_order;

RT_INLINE cwbvh_order cwbvh_order_of(const rt_rays *ray)
{
    cwbvh_order order;
    order.z = ray->iz < 0.0f ? 0xF0u : 0x0Fu;
    order.y = ray->iy < 0.0f ? 0xCCu : 0x33u;
    order.x = ray->ix < 0.0f ? 0xAAu : 0x55u;
    return order;
}

/* A plane is met at `near` or `far` plus steps. Other structures widen the far side by RT_WIDE, 16 RT_EPS of the distance. Here
 * that is added to `far` once a node, for the distance of byte 0. For the 255 steps from there it would be another 2^-12 of a
 * cell, for which CWBVH_MARGIN has room. So near and far planes have the same steps and a ray needs six numbers less: 80
 * registers instead of 96 on an H200. */
#define CWBVH_FAR(origin, inverse, ray_far, step, near)                                                                        \
    fma(fabs(fma(CWBVH_BIAS, step, near)), 16.0f * RT_EPS, fma(origin, inverse, ray_far))

/* The bits of the children that the ray enters before `t`, and their entry distances. `head` is the node's first row; x, y, z
 * are its rows of planes. */
RT_INLINE uint cwbvh_enter(const rt_rays *ray, float t, float4 head, float4 x, float4 y, float4 z, float4 *in0, float4 *in1)
{
    const uint cells = as_uint(head.s3);
    const float step_x = CWBVH_CELL(cells, 0u) * ray->ix, step_y = CWBVH_CELL(cells, 1u) * ray->iy,
                step_z = CWBVH_CELL(cells, 2u) * ray->iz;
    const float near_x = fma(head.s0, ray->ix, ray->near_x), near_y = fma(head.s1, ray->iy, ray->near_y),
                near_z = fma(head.s2, ray->iz, ray->near_z);
    const float far_x = CWBVH_FAR(head.s0, ray->ix, ray->far_x, step_x, near_x),
                far_y = CWBVH_FAR(head.s1, ray->iy, ray->far_y, step_y, near_y),
                far_z = CWBVH_FAR(head.s2, ray->iz, ray->far_z, step_z, near_z);
    const uint4 px = as_uint4(ray->ix < 0.0f ? x.s2301 : x), py = as_uint4(ray->iy < 0.0f ? y.s2301 : y),
                pz = as_uint4(ray->iz < 0.0f ? z.s2301 : z);
    uint entered = 0;
#define CWBVH_FOUR(near, far, in, bit)                                                                                         \
    {                                                                                                                          \
        const float4 ax = fma(CWBVH_PLANES(px.near), (float4)(step_x), (float4)(near_x));                                      \
        const float4 ay = fma(CWBVH_PLANES(py.near), (float4)(step_y), (float4)(near_y));                                      \
        const float4 az = fma(CWBVH_PLANES(pz.near), (float4)(step_z), (float4)(near_z));                                      \
        const float4 bx = fma(CWBVH_PLANES(px.far), (float4)(step_x), (float4)(far_x));                                        \
        const float4 by = fma(CWBVH_PLANES(py.far), (float4)(step_y), (float4)(far_y));                                        \
        const float4 bz = fma(CWBVH_PLANES(pz.far), (float4)(step_z), (float4)(far_z));                                        \
        *in = CWBVH_MAX(CWBVH_MAX(ax, ay), CWBVH_MAX(az, (float4)(ray->t_min)));                                                 \
        const float4 out = CWBVH_MIN(CWBVH_MIN(bx, by), CWBVH_MIN(bz, (float4)(t)));                                           \
        entered |= (in->s0 > out.s0 ? 0u : (bit)) | (in->s1 > out.s1 ? 0u : 2u * (bit)) | (in->s2 > out.s2 ? 0u : 4u * (bit)) | \
               (in->s3 > out.s3 ? 0u : 8u * (bit));                                                                            \
    }
    CWBVH_FOUR(s0, s2, in0, 1u)
    CWBVH_FOUR(s1, s3, in1, 16u)
#undef CWBVH_FOUR
    return entered;
}

/* Bit i becomes bits 4 i .. 4 i + 3. */
RT_INLINE uint cwbvh_spread(uint bits)
{
    bits = (bits | bits << 12) & 0x000F000Fu;
    bits = (bits | bits << 6) & 0x03030303u;
    bits = (bits | bits << 3) & 0x11111111u;
    return bits * 15u;
}

/* The bit of the slot that is visited first by the signs of the direction. */
RT_INLINE uint cwbvh_pick(const cwbvh_order *order, uint bits)
{
    bits = (bits & order->z) != 0u ? bits & order->z : bits;
    bits = (bits & order->y) != 0u ? bits & order->y : bits;
    bits = (bits & order->x) != 0u ? bits & order->x : bits;
    return bits & -bits;
}

/* The entry distance of the nearest child, with its slot in bits 0..2. *second: that of the next one, or a number above all
 * distances. */
RT_INLINE uint cwbvh_nearest(uint bits, float4 in0, float4 in1, uint *second)
{
#define CWBVH_KEY(in, slot) ((bits >> (slot)&1u) != 0u ? (as_uint(in) & ~7u) | (slot) : 0xFFFFFFFFu)
    const uint k0 = CWBVH_KEY(in0.s0, 0u), k1 = CWBVH_KEY(in0.s1, 1u), k2 = CWBVH_KEY(in0.s2, 2u), k3 = CWBVH_KEY(in0.s3, 3u);
    const uint k4 = CWBVH_KEY(in1.s0, 4u), k5 = CWBVH_KEY(in1.s1, 5u), k6 = CWBVH_KEY(in1.s2, 6u), k7 = CWBVH_KEY(in1.s3, 7u);
#undef CWBVH_KEY
    const uint a = min(k0, k1), b = min(k2, k3), c = min(k4, k5), d = min(k6, k7);
    const uint a2 = max(k0, k1), b2 = max(k2, k3), c2 = max(k4, k5), d2 = max(k6, k7);
    const uint ab = min(a, b), cd = min(c, d);
    const uint ab2 = min(max(a, b), min(a2, b2)), cd2 = min(max(c, d), min(c2, d2));
    *second = min(max(ab, cd), min(ab2, cd2));
    return min(ab, cd);
}

#else

/* A leaf as cl/lanes/packet_traversal.h has it on its stack. */
#define CWBVH_MAKE_LEAF(first, count) (0x80000000u | ((count) << 28) | (first))

/* A node's grid along the rays: they meet the plane of byte q at fma(step, CWBVH_BIAS + q, near) at the earliest. */
typedef struct cwbvh_grid {
    vfloat step_x, step_y, step_z, near_x, near_y, near_z, far_x, far_y, far_z;
} cwbvh_grid;

RT_INLINE cwbvh_grid cwbvh_make_grid(const global cwbvh_node *node, const rt_rays *ray)
{
    const uint cells = node->cells;
    const vfloat x = rt_vfloat(node->origin[0]), y = rt_vfloat(node->origin[1]), z = rt_vfloat(node->origin[2]);
    cwbvh_grid grid;
    grid.step_x = ray->ix * rt_vfloat(CWBVH_CELL(cells, 0u));
    grid.step_y = ray->iy * rt_vfloat(CWBVH_CELL(cells, 1u));
    grid.step_z = ray->iz * rt_vfloat(CWBVH_CELL(cells, 2u));
    grid.near_x = fma(ray->ix, x, ray->near_x);
    grid.near_y = fma(ray->iy, y, ray->near_y);
    grid.near_z = fma(ray->iz, z, ray->near_z);
    grid.far_x = fma(ray->ix, x, ray->far_x);
    grid.far_y = fma(ray->iy, y, ray->far_y);
    grid.far_z = fma(ray->iz, z, ray->far_z);
    return grid;
}

/* The lanes that enter a slot's box before their nearest hit. *entry is the distance of entry. A distance that is no number, as
 * products of huge coordinates may be, counts as entered. */
RT_INLINE vmask cwbvh_enter_slot(const global cwbvh_node *node, const cwbvh_grid *grid, uint slot, const rt_rays *ray,
                                 const rt_hits *hit, vfloat *entry)
{
    const uint word = slot >> 2, shift = 8u * (slot & 3u);
#define CWBVH_BYTE(axis, side) rt_vfloat(CWBVH_BIAS + (float)(node->planes[axis][word + (side)] >> shift & 255u))
    const vfloat lo_x = CWBVH_BYTE(0, 0u), lo_y = CWBVH_BYTE(1, 0u), lo_z = CWBVH_BYTE(2, 0u);
    const vfloat hi_x = CWBVH_BYTE(0, 2u), hi_y = CWBVH_BYTE(1, 2u), hi_z = CWBVH_BYTE(2, 2u);
#undef CWBVH_BYTE
    const vmask neg_x = rt_negative(ray->ix), neg_y = rt_negative(ray->iy), neg_z = rt_negative(ray->iz);
    const vfloat ax = fma(grid->step_x, rt_select(neg_x, hi_x, lo_x), grid->near_x);
    const vfloat ay = fma(grid->step_y, rt_select(neg_y, hi_y, lo_y), grid->near_y);
    const vfloat az = fma(grid->step_z, rt_select(neg_z, hi_z, lo_z), grid->near_z);
    const vfloat bx = fma(grid->step_x, rt_select(neg_x, lo_x, hi_x), grid->far_x);
    const vfloat by = fma(grid->step_y, rt_select(neg_y, lo_y, hi_y), grid->far_y);
    const vfloat bz = fma(grid->step_z, rt_select(neg_z, lo_z, hi_z), grid->far_z);
    vfloat out;
    rt_intersect_slabs(ax, ay, az, bx, by, bz, ray->t_min, hit->t, entry, &out);
    return ~RT_MASK(*entry > out);
}
#endif
#endif
#endif
