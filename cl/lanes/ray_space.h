/* ray_space.h -- a corner as a ray sees it, for every test that projects corners across the ray.
 *
 * z lies along the ray's dominant axis, x and y on the other two, sheared so that the ray is the z axis; all from the corner to the
 * ray's origin: which side of an edge the ray passes does not mind the sign (Woop, Benthin, Wald 2013, "Watertight Ray/Triangle
 * Intersection"). A lane's numbers are the same by either way, so a ray's hit does not depend on who travels with it. */
#ifndef RT_RAY_SPACE_H
#define RT_RAY_SPACE_H

#if RT_CPU

/* The number of `quad` that `axis`, 0 to 2, says for each lane: one permutation where four numbers fit into a part of a register. */
RT_INLINE vfloat rt_pick(float4 quad, vint axis)
{
#if !defined(RT_PORTABLE) && defined(__x86_64__) && RT_LANES == 16 && defined(__AVX512F__)
    return __builtin_ia32_vpermilvarps512((float16)(quad, quad, quad, quad), axis);
#elif !defined(RT_PORTABLE) && defined(__x86_64__) && RT_LANES == 8 && defined(__AVX__)
    return __builtin_ia32_vpermilvarps256((float8)(quad, quad), axis);
#elif !defined(RT_PORTABLE) && defined(__x86_64__) && RT_LANES == 4 && defined(__AVX__)
    return __builtin_ia32_vpermilvarps(quad, axis);
#else
    return rt_select(RT_MASK(axis == rt_vint(2)), rt_vfloat(quad.z),
                     rt_select(RT_MASK(axis == rt_vint(1)), rt_vfloat(quad.y), rt_vfloat(quad.x)));
#endif
}

/* `quad`: the three numbers at `corner`, and anything. */
RT_INLINE void rt_to_ray_space(const rt_rays *r, const global float *corner, float4 quad, vfloat *x, vfloat *y, vfloat *z)
{
#pragma OPENCL FP_CONTRACT OFF
    if (r->same_axis) {
        *z = r->pz - rt_vfloat(corner[r->kz]);
        *x = fma(r->sx, *z, r->px - rt_vfloat(corner[r->kx]));
        *y = fma(r->sy, *z, r->py - rt_vfloat(corner[r->ky]));
    } else {
        *z = r->pz - rt_pick(quad, r->axis_z);
        *x = fma(r->sx, *z, r->px - rt_pick(quad, r->axis_x));
        *y = fma(r->sy, *z, r->py - rt_pick(quad, r->axis_y));
    }
}

#else

/* Selected after the difference: what is from the origin is at hand, px, py and pz would be three registers more. */
RT_INLINE void rt_to_ray_space(const rt_rays *r, const global float *corner, float4 quad, vfloat *x, vfloat *y, vfloat *z)
{
#pragma OPENCL FP_CONTRACT OFF
    const vmask is_z = RT_MASK(r->axis_z == rt_vint(2)), is_y = RT_MASK(r->axis_z == rt_vint(1));
    const vfloat from_x = r->ox - rt_vfloat(quad.x), from_y = r->oy - rt_vfloat(quad.y), from_z = r->oz - rt_vfloat(quad.z);
    *z = rt_select(is_z, from_z, rt_select(is_y, from_y, from_x));
    *x = fma(r->sx, *z, rt_select(is_z, from_x, rt_select(is_y, from_z, from_y)));
    *y = fma(r->sy, *z, rt_select(is_z, from_y, rt_select(is_y, from_x, from_z)));
}

#ifdef RT_RAYS_PER_ITEM
/* Where a warp's rays have the same dominant axis k (warp_rays.cl) nothing is selected: a corner of `leaf` for the ray `r`. */
#define RT_TO_RAY_SPACE_AXIS(corner, i, j, k, x, y, z)                                                                                 \
    z = r->o##k - leaf->corner.k;                                                                                                \
    x = fma(r->sx, z, r->o##i - leaf->corner.i);                                                                                 \
    y = fma(r->sy, z, r->o##j - leaf->corner.j);
#endif

#endif
#endif
