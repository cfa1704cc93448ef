/* cone.cl -- the ray's interval inside of an endless double cone, cut with that between the planes of the ends.
 *
 * Between these planes there is one half of the double cone only, which is convex. So a closed cone is hit where the common interval
 * begins or ends, and no ray slips through between side and caps. The discriminant is computed at the ray's least distance to the
 * axis, where it does not cancel. numbers: one end, unit axis, length, radius there, growth of the radius along the axis, whether it
 * has caps. u: 0 on the side, 1 on the first cap, 2 on the other. */
RT_INLINE vfloat cone_hit(const global float *numbers, const global float *more, const rt_shape_rays *ray, vfloat *u, vfloat *v)
{
#pragma OPENCL FP_CONTRACT OFF
    const vfloat zero = rt_vfloat(0.0f), length = rt_vfloat(numbers[6]), growth = rt_vfloat(numbers[8]);
    const rt_vec axis = rt_spread(numbers + 3), from = rt_sub(ray->origin, rt_spread(numbers));
    const vfloat from_z = rt_dot(from, axis), dz = rt_dot(ray->direction, axis);
    const rt_vec p = rt_along(-from_z, axis, from), d = rt_along(-dz, axis, ray->direction);
    const vfloat radius = fma(growth, from_z, rt_vfloat(numbers[7])), widening = growth * dz;

    /* |p + t d|^2 <= (radius + t widening)^2, that is a t^2 - 2 b t + c <= 0. */
    const vfloat dd = rt_dot(d, d), pd = rt_dot(p, d);
    const vfloat a = dd - widening * widening, b = fma(widening, radius, -pd);
    const vfloat distance = sqrt(rt_dot(p, p)), c = (distance - radius) * (distance + radius);
    const vfloat closest = -pd / rt_max(dd, rt_vfloat(1e-30f));
    const rt_vec least = rt_along(closest, d, p);
    const vfloat away = sqrt(rt_dot(least, least)), there = fma(widening, closest, radius);
    const vfloat room = fma(dd, (there - away) * (there + away), widening * widening * away * away);
    const vfloat root = sqrt(rt_max(room, zero)), q = b + copysign(root, b);
    const vfloat t_a = q / a, t_b = rt_select(RT_MASK(q != zero), c / q, zero);
    const vfloat near_t = rt_min(t_a, t_b), far_t = rt_max(t_a, t_b);

    const vfloat inverse = rt_safe_reciprocal(dz), at_from = -from_z * inverse, at_to = (length - from_z) * inverse;
    const vfloat caps_in = rt_min(at_from, at_to), caps_out = rt_max(at_from, at_to);
    /* A flat ray is inside between the two roots. A steep one is inside before the first and after the second, once in each half
     * of the double cone. */
    const vmask flat = RT_MASK(a >= zero), before = ~flat & RT_MASK(caps_in <= near_t);
    const vfloat side_in = rt_select(flat, near_t, rt_select(before, -RT_INFINITY, far_t));
    const vfloat side_out = rt_select(flat, far_t, rt_select(before, near_t, RT_INFINITY));
    const vmask meets = RT_MASK(room >= zero) | ~flat;
    const vmask hits = meets & RT_MASK(rt_max(side_in, caps_in) <= rt_min(side_out, caps_out));
    vfloat in = rt_max(side_in, caps_in), out = rt_min(side_out, caps_out);
    const vmask in_side = RT_MASK(side_in >= caps_in), out_side = RT_MASK(side_out <= caps_out);
    if (numbers[9] == 0.0f) {
        in = rt_select(in_side, in, RT_INFINITY);
        out = rt_select(out_side, out, RT_INFINITY);
    }
    const vmask first = RT_MASK(in >= ray->t_min) & RT_MASK(in < RT_INFINITY);
    const vfloat t = rt_select(first, in, out);
    const vmask on_side = rt_select(first, in_side, out_side);
    *u = rt_select(on_side, zero, rt_select(RT_MASK(t == at_from), rt_vfloat(1.0f), rt_vfloat(2.0f)));
    return rt_select(hits & RT_MASK(t >= ray->t_min), t, RT_INFINITY);
}

RT_INLINE void cone_surface(const global float *numbers, const global float *more, rt_vec at, vfloat u, vfloat v, rt_shape_surface *s)
{
#pragma OPENCL FP_CONTRACT OFF
    const rt_vec axis = rt_spread(numbers + 3), from = rt_sub(at, rt_spread(numbers));
    const vfloat z = rt_dot(from, axis), length = rt_vfloat(numbers[6]), growth = rt_vfloat(numbers[8]);
    const rt_vec from_axis = rt_along(-z, axis, from);
    const vfloat away = sqrt(rt_dot(from_axis, from_axis)), radius = fma(growth, z, rt_vfloat(numbers[7]));
    const vmask side = RT_MASK(u < rt_vfloat(0.5f)), first = RT_MASK(u < rt_vfloat(1.5f));
    const rt_vec cap = rt_scale(rt_select(first, rt_vfloat(-1.0f), rt_vfloat(1.0f)), axis);
    /* A point of a very thin one may be rounded onto the axis, where every direction across it is a normal. */
    rt_vec x, y;
    rt_across(numbers + 3, &x, &y);
    const rt_vec outward = rt_choose(RT_MASK(away > rt_vfloat(1e-30f)), rt_scale(rt_vfloat(1.0f) / rt_max(away, rt_vfloat(1e-30f)), from_axis), x);
    const rt_vec slope = rt_along(-growth, axis, outward);
    s->normal = rt_choose(side, slope, cap);
    s->height = rt_select(side, (away - radius) / sqrt(fma(growth, growth, rt_vfloat(1.0f))), rt_select(first, -z, z - length));
    if (!s->wants_uv) return;
    s->tex_u = rt_turns(rt_dot(from_axis, x), rt_dot(from_axis, y));
    s->tex_v = rt_select(side, z / length, away / rt_max(radius, rt_vfloat(1e-30f)));
}
