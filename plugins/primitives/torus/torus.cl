/* torus.cl -- ray/torus.
 *
 * A point of the ray is in the torus where a quartic polynomial is negative. Between neighbouring extrema it has one root at most
 * (Yuksel 2022, "High-Performance Polynomial Root Finding for Graphics"), so no root is missed. Values of the polynomial cancel in
 * floats, but the distance of a point from the tube does not: its sign decides between which extrema the first root is, and its root
 * is the hit. Lengths are multiples of the ring's radius, and s is the distance from the ray's point next to the centre.
 * numbers: centre, unit axis, radius of the ring, of the tube. */

#define TORUS_STEPS 12 /* of Newton's method or bisection: each bracket is at most as wide as the ring */

/* A ray, with its s from start to end. */
typedef struct torus_ray {
    vfloat m2, z, dz; /* squared distance from the centre at s = 0; height there, and what it grows with s */
    vfloat tube;
    vfloat c1, c2;    /* coefficients of the quartic, in which that of s^4 is 1 and that of s^3 is 0 */
} torus_ray;

/* A point's distance from the tube, negative inside, and its derivative by s. */
RT_INLINE vfloat torus_distance(const torus_ray *r, vfloat s, vfloat *slope)
{
#pragma OPENCL FP_CONTRACT OFF
    const vfloat one = rt_vfloat(1.0f), tiny = rt_vfloat(1e-20f);
    const vfloat z = fma(s, r->dz, r->z), across2 = rt_max(fma(s, s, r->m2) - z * z, tiny);
    const vfloat across = sqrt(across2), from_ring = across - one;
    const vfloat away = sqrt(rt_max(fma(from_ring, from_ring, z * z), tiny));
    *slope = fma(from_ring, (s - z * r->dz) / across, z * r->dz) / away;
    return away - r->tube;
}

/* Half of the quartic's derivative, and that one's derivative. */
RT_INLINE vfloat torus_extremum(const torus_ray *r, vfloat s, vfloat *slope)
{
#pragma OPENCL FP_CONTRACT OFF
    *slope = fma(rt_vfloat(6.0f) * s, s, r->c2);
    return fma(fma(rt_vfloat(2.0f) * s, s, r->c2), s, rt_vfloat(0.5f) * r->c1);
}

/* A root of `value` between a and b, if its signs differ there; otherwise some number between. */
#define TORUS_ROOT(value, r, a, b, root)                                                                                       \
    {                                                                                                                          \
        vfloat low = a, high = b, slope;                                                                                       \
        const vmask falls = ~RT_MASK(value(r, low, &slope) < rt_vfloat(0.0f)); /* 0 counts as positive, as below */            \
        root = 0.5f * (low + high);                                                                                            \
        for (uint step = 0; step < TORUS_STEPS; ++step) {                                                                      \
            const vfloat y = value(r, root, &slope);                                                                           \
            const vmask before = RT_MASK(y > rt_vfloat(0.0f)) ^ ~falls;                                                        \
            low = rt_select(before, root, low);                                                                                \
            high = rt_select(before, high, root);                                                                              \
            const vfloat next = root - y / slope;                                                                              \
            root = rt_select(RT_MASK(next >= low) & RT_MASK(next <= high), next, 0.5f * (low + high));                         \
        }                                                                                                                      \
    }

RT_INLINE vfloat torus_hit(const global float *numbers, const global float *more, const rt_shape_rays *ray, vfloat *u, vfloat *v)
{
#pragma OPENCL FP_CONTRACT OFF
    const vfloat zero = rt_vfloat(0.0f), scale = rt_vfloat(1.0f / numbers[6]), room = rt_vfloat(1.001f);
    const rt_vec axis = rt_spread(numbers + 3), from = rt_scale(scale, rt_sub(ray->origin, rt_spread(numbers)));
    const vfloat inverse_length = rt_inverse_length(ray->direction), per_s = inverse_length * rt_vfloat(numbers[6]);
    const rt_vec d = rt_scale(inverse_length, ray->direction);
    const vfloat closest = -rt_dot(from, d);
    const rt_vec m = rt_along(closest, d, from);
    torus_ray r;
    r.tube = rt_vfloat(numbers[7]) * scale;
    r.m2 = rt_dot(m, m);
    r.z = rt_dot(m, axis);
    r.dz = rt_dot(d, axis);

    /* The part of the ray in a sphere around the torus and between the planes that touch it, both with some room. */
    const vfloat outer = (rt_vfloat(1.0f) + r.tube) * room, half_way2 = outer * outer - r.m2, half_way = sqrt(rt_max(half_way2, zero));
    const vfloat inverse = rt_safe_reciprocal(r.dz), top = r.tube * room;
    const vfloat at_top = (top - r.z) * inverse, at_bottom = (-top - r.z) * inverse;
    vfloat start = rt_max(rt_max(-half_way, rt_min(at_top, at_bottom)), ray->t_min / per_s - closest);
    const vfloat end = rt_min(half_way, rt_max(at_top, at_bottom));
    const vmask meets = RT_MASK(half_way2 >= zero) & RT_MASK(start <= end);
    if (!rt_any(meets)) return RT_INFINITY;
    start = rt_min(start, end);

    /* (s^2 + k)^2 - 4 (s^2 + m^2 - (z + s dz)^2), k = m^2 + 1 - tube^2 */
    const vfloat k = r.m2 + (rt_vfloat(1.0f) - r.tube) * (rt_vfloat(1.0f) + r.tube);
    r.c2 = 2.0f * k - 4.0f * (rt_vfloat(1.0f) - r.dz * r.dz);
    r.c1 = 8.0f * r.z * r.dz;
    const vfloat bend = sqrt(rt_max(r.c2 * rt_vfloat(-1.0f / 6.0f), zero));
    const vfloat bend_a = rt_min(rt_max(-bend, start), end), bend_b = rt_min(rt_max(bend, start), end);
    vfloat at[5];
    at[0] = start;
    at[4] = end;
    TORUS_ROOT(torus_extremum, &r, start, bend_a, at[1])
    TORUS_ROOT(torus_extremum, &r, bend_a, bend_b, at[2])
    TORUS_ROOT(torus_extremum, &r, bend_b, end, at[3])

    vfloat a = start, b = start, slope;
    const vmask inside = RT_MASK(torus_distance(&r, start, &slope) < zero);
    vmask searching = meets;
    for (uint i = 1; i < 5u; ++i) {
        const vmask changes = searching & (RT_MASK(torus_distance(&r, at[i], &slope) < zero) ^ inside);
        a = rt_select(changes, at[i - 1u], a);
        b = rt_select(changes, at[i], b);
        searching &= ~changes;
    }
    const vmask found = meets & ~searching;
    if (!rt_any(found)) return RT_INFINITY;
    vfloat s;
    TORUS_ROOT(torus_distance, &r, a, b, s)
    const vfloat t = rt_max((closest + s) * per_s, ray->t_min);
    return rt_select(found, t, RT_INFINITY);
}
#undef TORUS_ROOT
#undef TORUS_STEPS

RT_INLINE void torus_surface(const global float *numbers, const global float *more, rt_vec at, vfloat u, vfloat v, rt_shape_surface *s)
{
#pragma OPENCL FP_CONTRACT OFF
    const rt_vec axis = rt_spread(numbers + 3), from = rt_sub(at, rt_spread(numbers));
    const vfloat z = rt_dot(from, axis), ring = rt_vfloat(numbers[6]);
    const rt_vec flat = rt_along(-z, axis, from);
    const vfloat across = rt_max(sqrt(rt_dot(flat, flat)), rt_vfloat(1e-30f));
    const rt_vec of_tube = rt_along(-ring / across, flat, from);
    const vfloat away = sqrt(rt_dot(of_tube, of_tube));
    /* A point of a very thin tube may be rounded onto its middle, where the axis is as good as other normals. */
    s->normal = rt_choose(RT_MASK(away > rt_vfloat(0.0f)), of_tube, axis);
    s->height = away - rt_vfloat(numbers[7]);
    if (!s->wants_uv) return;
    rt_vec x, y;
    rt_across(numbers + 3, &x, &y);
    s->tex_u = rt_turns(rt_dot(flat, x), rt_dot(flat, y));
    s->tex_v = rt_turns(across - ring, z);
}
