/* cylinder.cl -- the ray's interval inside of an endless cylinder, cut with that between the planes of the ends.
 *
 * The discriminant comes from the ray's least distance to the axis, as sphere.h has it: b^2 - 4ac would cancel. A closed cylinder is
 * hit where the common interval begins or ends, so no ray slips through between side and caps. numbers: one end, unit axis, length,
 * radius, whether it has caps. u: 0 on the side, 1 on the first cap, 2 on the other. */
RT_INLINE vfloat cylinder_hit(const global float *numbers, const global float *more, const rt_shape_rays *ray, vfloat *u, vfloat *v)
{
#pragma OPENCL FP_CONTRACT OFF
    const vfloat zero = rt_vfloat(0.0f), length = rt_vfloat(numbers[6]), radius2 = rt_vfloat(numbers[7] * numbers[7]);
    const rt_vec axis = rt_spread(numbers + 3), from = rt_sub(ray->origin, rt_spread(numbers));
    const vfloat from_z = rt_dot(from, axis), dz = rt_dot(ray->direction, axis);
    const rt_vec from_axis = rt_along(-from_z, axis, from), d = rt_along(-dz, axis, ray->direction);

    const vfloat a = rt_max(rt_dot(d, d), rt_vfloat(1e-30f)), b = -rt_dot(from_axis, d);
    const rt_vec least = rt_along(b / a, d, from_axis);
    const vfloat room = radius2 - rt_dot(least, least), root = sqrt(rt_max(room, zero) * a);
    const vfloat q = b + copysign(root, b), c = rt_dot(from_axis, from_axis) - radius2;
    const vfloat t_a = q / a, t_b = rt_select(RT_MASK(q != zero), c / q, zero);
    const vfloat side_in = rt_min(t_a, t_b), side_out = rt_max(t_a, t_b);

    const vfloat inverse = rt_safe_reciprocal(dz), at_from = -from_z * inverse, at_to = (length - from_z) * inverse;
    const vfloat caps_in = rt_min(at_from, at_to), caps_out = rt_max(at_from, at_to);
    const vmask hits = RT_MASK(room >= zero) & RT_MASK(rt_max(side_in, caps_in) <= rt_min(side_out, caps_out));
    vfloat in = rt_max(side_in, caps_in), out = rt_min(side_out, caps_out);
    const vmask in_side = RT_MASK(side_in >= caps_in), out_side = RT_MASK(side_out <= caps_out);
    if (numbers[8] == 0.0f) {
        in = rt_select(in_side, in, RT_INFINITY);
        out = rt_select(out_side, out, RT_INFINITY);
    }
    const vmask first = RT_MASK(in >= ray->t_min) & RT_MASK(in < RT_INFINITY);
    const vfloat t = rt_select(first, in, out);
    const vmask on_side = rt_select(first, in_side, out_side);
    const vmask at_start = RT_MASK(t == at_from);
    *u = rt_select(on_side, zero, rt_select(at_start, rt_vfloat(1.0f), rt_vfloat(2.0f)));
    return rt_select(hits & RT_MASK(t >= ray->t_min), t, RT_INFINITY);
}

RT_INLINE void cylinder_surface(const global float *numbers, const global float *more, rt_vec at, vfloat u, vfloat v,
                                rt_shape_surface *s)
{
#pragma OPENCL FP_CONTRACT OFF
    const rt_vec axis = rt_spread(numbers + 3), from = rt_sub(at, rt_spread(numbers));
    const vfloat z = rt_dot(from, axis), length = rt_vfloat(numbers[6]);
    const rt_vec from_axis = rt_along(-z, axis, from);
    const vfloat away = sqrt(rt_dot(from_axis, from_axis));
    const vmask side = RT_MASK(u < rt_vfloat(0.5f)), first = RT_MASK(u < rt_vfloat(1.5f));
    const rt_vec cap = rt_scale(rt_select(first, rt_vfloat(-1.0f), rt_vfloat(1.0f)), axis);
    /* A point of a very thin one may be rounded onto the axis, where every direction across it is a normal. */
    rt_vec x, y;
    rt_across(numbers + 3, &x, &y);
    s->normal = rt_choose(side, rt_choose(RT_MASK(away > rt_vfloat(0.0f)), from_axis, x), cap);
    s->height = rt_select(side, away - rt_vfloat(numbers[7]), rt_select(first, -z, z - length));
    if (!s->wants_uv) return;
    s->tex_u = rt_turns(rt_dot(from_axis, x), rt_dot(from_axis, y));
    s->tex_v = rt_select(side, z / length, away / rt_vfloat(numbers[7]));
}
