/* cell_parts.h -- where in a cell the boxes of its primitives are: a number of 32 bits beside each name in the cell's list, so
 * that a ray or a packet is compared with RT_LANES boxes at once, and few primitives are left to be read and tested.
 *
 * A cell has 32 parts along each axis. The lowest five bits are the first part along x that the box meets, the next five are
 * the last one; so on along y and z (PartRange of clarity_space/cells.hpp). Boxes that reach beyond the cell end with it. A box
 * has the slack of cells (see "Slack" in CONTRACT.md). No bits are shifted to read a part: its number, with the other bits
 * cleared, stays multiplied by a power of 2, and is compared with a distance that is multiplied by the same power. */
#ifndef RT_CELL_PARTS_H
#define RT_CELL_PARTS_H

#define RT_PARTS 32.0f                                     /* in a cell along an axis */
#define RT_PART_BITS 5                                     /* of the number of a part */
#define RT_PARTS_OF(axis) (2 * RT_PART_BITS * (int)(axis)) /* where the bits of an axis begin */
#define RT_PART_AT(place) (31 << (place))

RT_INLINE float rt_power_of_2(int n) {
    return as_float((127 + n) << 23);
}

/* The numbers of the parts at a place of the bits, times 2^place. */
RT_INLINE vfloat rt_part_numbers(vint parts, int bits) {
    return rt_to_float(parts & rt_vint(bits));
}

/* The boxes of up to RT_LANES names. Reads RT_LANES numbers. */
RT_INLINE vint rt_load_parts(const global uint* parts) {
#if RT_LANES == 1
    return (int)*parts;
#else
    return *(const global rt_unaligned_vint*)parts;
#endif
}

/* The bits of the first `count` lanes, or of all. */
RT_INLINE uint rt_first_lanes(uint count) {
    return count < RT_LANES ? (1u << count) - 1u : RT_ALL_LANES;
}

/* What one ray needs along one axis: which part's plane it meets first and which last, and when, from the cell's low side on.
 */
typedef struct rt_part_axis {
    int near_bits, far_bits;
    float near_rise, near_more, far_rise, far_more;
} rt_part_axis;

typedef struct rt_part_ray {
    rt_part_axis x, y, z;
} rt_part_ray;

RT_INLINE void rt_begin_part_axis(rt_part_axis* a, int place, float size, float inverse) {
    const float part = inverse * size * (1.0f / RT_PARTS);
    const int near = inverse < 0.0f ? place + RT_PART_BITS : place, far = inverse < 0.0f ? place : place + RT_PART_BITS;
    a->near_bits = RT_PART_AT(near), a->far_bits = RT_PART_AT(far);
    a->near_rise = part * rt_power_of_2(-near), a->far_rise = part * rt_power_of_2(-far);
    /* A last part ends where the next one begins. One more on either side, because a ray may be beside the cell by the rounding
     * of cells.h. */
    a->near_more = rt_min(part, 0.0f) - fabs(part), a->far_more = rt_max(part, 0.0f) + fabs(part);
}

/* size: of cells. */
RT_INLINE void rt_begin_part_ray(rt_part_ray* p, const global float* size, const rt_single_ray* ray) {
    rt_begin_part_axis(&p->x, RT_PARTS_OF(0), size[0], ray->ix);
    rt_begin_part_axis(&p->y, RT_PARTS_OF(1), size[1], ray->iy);
    rt_begin_part_axis(&p->z, RT_PARTS_OF(2), size[2], ray->iz);
}

/* The bits of those of `count` boxes, or of the first RT_LANES, that a ray enters before its nearest hit. cells: where it is
 * (cells.h). */
RT_INLINE uint rt_ray_meets(const rt_part_ray* p, const rt_cells* cells, const rt_single_ray* ray, const rt_single_hit* hit,
                            const global uint* parts, uint count) {
    const vint all = rt_load_parts(parts);
    const float x = fma((float)cells->x.at, cells->x.size, cells->x.low),
                y = fma((float)cells->y.at, cells->y.size, cells->y.low),
                z = fma((float)cells->z.at, cells->z.size, cells->z.low);
#define RT_PART_PLANE(axis, side)                                                  \
    fma(rt_vfloat(p->axis.side##_rise), rt_part_numbers(all, p->axis.side##_bits), \
        rt_vfloat(fma(ray->i##axis, axis, ray->side##_##axis) + p->axis.side##_more))
    const vfloat in =
        rt_max(rt_max(RT_PART_PLANE(x, near), RT_PART_PLANE(y, near)), rt_max(RT_PART_PLANE(z, near), rt_vfloat(ray->t_min)));
    const vfloat out = rt_min(rt_min(RT_PART_PLANE(x, far), RT_PART_PLANE(y, far)), RT_PART_PLANE(z, far)) * rt_vfloat(RT_WIDE);
#undef RT_PART_PLANE
    return rt_bits(RT_MASK(in <= rt_min(out, rt_vfloat(hit->t)))) & rt_first_lanes(count);
}

#endif
