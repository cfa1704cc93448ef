/* bvh8_mixed_rays.h -- values that the slab tests of bvh8_incoherent.cl need of rays with directions of different signs. */
#ifndef BVH8_MIXED_RAYS_H
#define BVH8_MIXED_RAYS_H

/* A lower plane p is met at fma(lo_slope, p, lo_offset), an upper one at fma(hi_slope, p, hi_offset). Each has the slack that
 * it needs as the near or the far plane of its lane. The far side is widened here, as in bvh8_single_ray.cl. */
typedef struct bvh8_mixed_rays {
    vfloat lo_slope_x, lo_slope_y, lo_slope_z, lo_offset_x, lo_offset_y, lo_offset_z;
    vfloat hi_slope_x, hi_slope_y, hi_slope_z, hi_offset_x, hi_offset_y, hi_offset_z;
    uint far_first; /* bits of the slot that is visited last, by the signs on which the lanes mostly agree */
} bvh8_mixed_rays;

RT_INLINE bvh8_mixed_rays bvh8_mix_rays(const rt_rays *ray)
{
    bvh8_mixed_rays r;
    r.far_first = (ray->lo_x == 0u ? 1u : 0u) | (ray->lo_y == 1u ? 2u : 0u) | (ray->lo_z == 2u ? 4u : 0u);
#define BVH8_AXIS(x)                                                                                                           \
    const vmask negative_##x = rt_negative(ray->i##x);                                                                         \
    const vfloat wide_##x = ray->i##x * RT_WIDE, exit_##x = ray->far_##x * RT_WIDE;                                            \
    r.lo_slope_##x = rt_select(negative_##x, wide_##x, ray->i##x);                                                             \
    r.lo_offset_##x = rt_select(negative_##x, exit_##x, ray->near_##x);                                                        \
    r.hi_slope_##x = rt_select(negative_##x, ray->i##x, wide_##x);                                                             \
    r.hi_offset_##x = rt_select(negative_##x, ray->near_##x, exit_##x);
    BVH8_AXIS(x)
    BVH8_AXIS(y)
    BVH8_AXIS(z)
#undef BVH8_AXIS
    return r;
}

#endif
