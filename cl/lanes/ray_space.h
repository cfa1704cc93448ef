/* ray_space.h -- a ray's own space, and the steps that the tests of triangles and polygons share there.
 *
 * Woop, Benthin, Wald 2013, "Watertight Ray/Triangle Intersection". In ray space the ray's origin is the origin. z is the ray's
 * dominant axis; x and y are the other two, sheared so that the ray lies on the z axis. All coordinates are those of origin -
 * point, not of point - origin: on which side of an edge the ray passes does not depend on the sign. The numbers of a lane are
 * the same by every way below, so a ray's hit does not depend on the rays that are traced with it. */
#ifndef RT_RAY_SPACE_H
#define RT_RAY_SPACE_H

/* The steps are macros: a test has its numbers as scalars, as lanes of rays or as lanes of triangles. A test that uses them
 * says FP_CONTRACT OFF, so that each product is rounded. */

/* x or y of a point from its z. origin, point: their coordinates on the axis. */
#define RT_SHEARED(shear, z, origin, point) fma(shear, z, (origin) - (point))

/* The edge function: twice the signed area of the triangle of the ray and the points p and q. A difference of two rounded
 * products: rounding is monotone, so the sign is right or the result is 0. */
#define RT_EDGE(px, py, qx, qy) ((px) * (qy) - (py) * (qx))

#define RT_MIN3(a, b, c) rt_min(rt_min(a, b), c)
#define RT_MAX3(a, b, c) rt_max(rt_max(a, b), c)

/* The distance at which a ray hits a triangle or polygon, from `height` and `facing`: the dot products of the normal with
 * corner - origin and with the direction. The plane's distance is exact far away, where corners weighted with u, v, w would
 * cancel, as on a floor. A plane that is seen edge-on has no distance, so it is kept between those of the nearest and the
 * farthest corner, lo and hi. */
#define RT_PLANE_DISTANCE(height, facing, lo, hi) rt_min(rt_max((height) / (facing), lo), hi)

#define RT_DOT(ax, ay, az, bx, by, bz) fma(ax, bx, fma(ay, by, (az) * (bz)))

/* The normal of a triangle, (b - a) x (c - a), not of unit length. Times a coordinate it is a volume, which is no float in scenes of 1e13 and
 * keeps few digits in those of 1e-14: there the edges count as multiplied by RT_NORMAL_SCALE. */
#define RT_NORMAL_SCALE (1.0f / RT_SCENE_SCALE)
RT_INLINE void rt_triangle_normal(float ax, float ay, float az, float bx, float by, float bz, float cx, float cy, float cz, float *nx,
                                  float *ny, float *nz)
{
#pragma OPENCL FP_CONTRACT OFF
    const float e1x = (bx - ax) * RT_NORMAL_SCALE, e1y = (by - ay) * RT_NORMAL_SCALE, e1z = (bz - az) * RT_NORMAL_SCALE;
    const float e2x = (cx - ax) * RT_NORMAL_SCALE, e2y = (cy - ay) * RT_NORMAL_SCALE, e2z = (cz - az) * RT_NORMAL_SCALE;
    *nx = e1y * e2z - e1z * e2y;
    *ny = e1z * e2x - e1x * e2z;
    *nz = e1x * e2y - e1y * e2x;
}

#if RT_CPU

/* The number of `quad` that `axis`, 0 to 2, selects for each lane. One permutation where four numbers fit into a part of a
 * register. */
RT_INLINE vfloat rt_pick(float4 quad, vint axis)
{
#if !defined(RT_PORTABLE) && RT_LANES == 16 && defined(__AVX512F__) && RT_HAS_BUILTIN(__builtin_ia32_vpermilvarps512)
    return __builtin_ia32_vpermilvarps512((float16)(quad, quad, quad, quad), axis);
#elif !defined(RT_PORTABLE) && RT_LANES == 8 && defined(__AVX__) && RT_HAS_BUILTIN(__builtin_ia32_vpermilvarps256)
    return __builtin_ia32_vpermilvarps256((float8)(quad, quad), axis);
#elif !defined(RT_PORTABLE) && RT_LANES == 4 && defined(__AVX__) && RT_HAS_BUILTIN(__builtin_ia32_vpermilvarps)
    return __builtin_ia32_vpermilvarps(quad, axis);
#else
    return rt_select(RT_MASK(axis == rt_vint(2)), rt_vfloat(quad.z),
                     rt_select(RT_MASK(axis == rt_vint(1)), rt_vfloat(quad.y), rt_vfloat(quad.x)));
#endif
}

/* A corner in the ray space of each lane, where all lanes have one dominant axis. */
RT_INLINE void rt_to_ray_space_of_one_axis(const rt_rays *r, const global float *corner, vfloat *x, vfloat *y, vfloat *z)
{
#pragma OPENCL FP_CONTRACT OFF
    *z = r->pz - rt_vfloat(corner[r->kz]);
    *x = RT_SHEARED(r->sx, *z, r->px, rt_vfloat(corner[r->kx]));
    *y = RT_SHEARED(r->sy, *z, r->py, rt_vfloat(corner[r->ky]));
}

/* The same where they have several. quad: the three numbers of the corner, and any fourth. */
RT_INLINE void rt_to_ray_space_of_axes(const rt_rays *r, float4 quad, vfloat *x, vfloat *y, vfloat *z)
{
#pragma OPENCL FP_CONTRACT OFF
    *z = r->pz - rt_pick(quad, r->axis_z);
    *x = RT_SHEARED(r->sx, *z, r->px, rt_pick(quad, r->axis_x));
    *y = RT_SHEARED(r->sy, *z, r->py, rt_pick(quad, r->axis_y));
}

/* The same of all rays. quad: the three numbers at `corner`, and any fourth. */
RT_INLINE void rt_to_ray_space(const rt_rays *r, const global float *corner, float4 quad, vfloat *x, vfloat *y, vfloat *z)
{
    if (r->same_axis)
        rt_to_ray_space_of_one_axis(r, corner, x, y, z);
    else
        rt_to_ray_space_of_axes(r, quad, x, y, z);
}

#else

/* The same. Axes are selected after the difference from the origin: px, py and pz would take three registers more. */
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
/* The same for a corner of `leaf` where all rays of a warp have the dominant axis k (warp_rays.cl): nothing is selected. */
#define RT_TO_RAY_SPACE_AXIS(corner, i, j, k, x, y, z)                                                                         \
    z = r->o##k - leaf->corner.k;                                                                                              \
    x = RT_SHEARED(r->sx, z, r->o##i, leaf->corner.i);                                                                         \
    y = RT_SHEARED(r->sy, z, r->o##j, leaf->corner.j);
#endif

#endif
#endif
