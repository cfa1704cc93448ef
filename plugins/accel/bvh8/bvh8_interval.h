/* bvh8_interval.h -- the octants of a packet, and the interval of its rays: bounds of their origins and reciprocal directions.
 *
 * The interval's slab test enters every box that a ray of the packet enters (Boulos, Wald, Shirley 2006, "Geometric and
 * Arithmetic Culling Methods for Entire Ray Packets"). It needs directions of one octant. */
#ifndef BVH8_INTERVAL_H
#define BVH8_INTERVAL_H

/* The most octants that a packet is split by. The rays of a packet that has more have too little in common. */
#define BVH8_MAX_OCTANTS 2

/* Each lane's octant. Bits 0, 1, 2: the direction's component in x, y, z is negative. */
RT_INLINE vint bvh8_octants(const rt_rays *ray)
{
    return (rt_negative(ray->ix) & rt_vint(1)) | (rt_negative(ray->iy) & rt_vint(2)) | (rt_negative(ray->iz) & rt_vint(4));
}

/* The octants of active lanes, octant i in bit i. t: the packet's rt_hits.t. */
RT_INLINE uint bvh8_octant_bits(const rt_rays *ray, vint octants, vfloat t)
{
    const vmask active = RT_MASK(t >= rt_vfloat(0.0f));
    if (!rt_any(active)) return 0u;
    if (ray->coherent) return 1u << ((ray->lo_x != 0u ? 1u : 0u) | (ray->lo_y != 1u ? 2u : 0u) | (ray->lo_z != 2u ? 4u : 0u));
    uint bits = 0;
    for (int i = 0; i < 8; ++i) bits |= (rt_any(active & RT_MASK(octants == rt_vint(i))) ? 1u : 0u) << i;
    return bits;
}

/* The lanes that an interval bounds: they are active, and their origins are finite. A ray that starts at NaN or infinity hits
 * nothing, but the bounds would no longer hold for the other rays. Such an origin times zero is NaN, and NaN >= 0 is false. */
RT_INLINE vmask bvh8_bounded(const rt_rays *ray, vfloat t)
{
    return RT_MASK(fma(ray->ox + ray->oy + ray->oz, rt_vfloat(0.0f), t) >= rt_vfloat(0.0f));
}

RT_INLINE bvh8_rows bvh8_octant_rows(uint octant)
{
    return bvh8_rows_of((octant & 1u) != 0u, (octant & 2u) != 0u, (octant & 4u) != 0u);
}

/* -origin / direction, rounded outwards by the slack of rt_prepare_for_boxes(), for near and for far planes. */
#define BVH8_NEAR_OFFSET(origin, slope) (-(origin) * (slope) - fabs((origin) * (slope)) * (8.0f * RT_EPS))
#define BVH8_FAR_OFFSET(origin, slope)                                                                                         \
    (-(origin) * (slope) + (fabs((origin) * (slope)) * (8.0f * RT_EPS) + fabs(slope) * RT_FAR_SLACK))

/* Whether an interval is so wide that its rays are tested too before a node is visited. As a mask of numbers or of lanes. */
#define BVH8_IS_WIDE(o_lo, o_hi, i_lo, i_hi) (RT_MASK((o_lo) != (o_hi)) | RT_MASK((i_hi) - (i_lo) > 0.25f * fabs(i_lo)))

/* One number of one child. box: the address of the child's number in the first row. */
#define BVH8_PLANE(box, bytes) rt_vfloat(*(const global float *)((box) + (bytes)))

/* Returns the bits of the lanes with rays that enter one child before their nearest hits. */
RT_INLINE uint bvh8_enter_child(const global char *box, const bvh8_rows *rows, const rt_rays *ray, const rt_hits *hit)
{
    vfloat entry;
    return rt_bits(rt_enter_planes(BVH8_PLANE(box, rows->near_x), BVH8_PLANE(box, rows->near_y), BVH8_PLANE(box, rows->near_z),
                                   BVH8_PLANE(box, rows->far_x), BVH8_PLANE(box, rows->far_y), BVH8_PLANE(box, rows->far_z), ray, hit,
                                   &entry));
}

#endif
