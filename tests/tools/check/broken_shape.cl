/* broken_shape.cl -- a ball, stretched along y. numbers: centre, radius, stretch, and the number of the defect, 0 for none. */
enum {
    BROKEN_SHAPE_FAR_ROOT = 1, BROKEN_SHAPE_OCTANT, BROKEN_SHAPE_ONE_SIDED, BROKEN_SHAPE_FORGETS_T_MIN, BROKEN_SHAPE_FIRST_LANE,
    BROKEN_SHAPE_UNIT_DIRECTION, BROKEN_SHAPE_WRONG_RADIUS, BROKEN_SHAPE_WRONG_SCALE, BROKEN_SHAPE_WRONG_NORMAL, BROKEN_SHAPE_INWARD,
    BROKEN_SHAPE_WRONG_UV, BROKEN_SHAPE_INEXACT, BROKEN_SHAPE_READS_BEYOND, BROKEN_SHAPE_LOOP, BROKEN_SHAPE_HOLE, BROKEN_SHAPE_NAN,
    BROKEN_SHAPE_LANES_8, BROKEN_SHAPE_ZERO_RADIUS,
    BROKEN_SHAPE_UV_SEAM, BROKEN_SHAPE_UV_OFF_CENTRE, BROKEN_SHAPE_UV_WORLD_CENTRE, BROKEN_SHAPE_UV_TWICE, BROKEN_SHAPE_UV_CONSTANT,
    BROKEN_SHAPE_UV_ONE_DIRECTION, BROKEN_SHAPE_UV_STEPS, BROKEN_SHAPE_UV_HALVES, BROKEN_SHAPE_UV_NEVER_ENDS, BROKEN_SHAPE_UV_MIRRORED_HALF,
    BROKEN_SHAPE_AXIS, BROKEN_SHAPE_SLIM, BROKEN_SHAPE_UV_CLAMPED
};

/* The vector in the space where the ball has the radius 1. */
RT_INLINE rt_vec broken_shape_unit(const global float *numbers, rt_vec v)
{
    const vfloat radius = rt_vfloat(numbers[3]);
    return rt_vec_of(v.x / radius, v.y / (radius * rt_vfloat(numbers[4])), v.z / radius);
}

RT_INLINE vfloat broken_shape_hit(const global float *numbers, const global float *more, const rt_shape_rays *ray, vfloat *u, vfloat *v)
{
#pragma OPENCL FP_CONTRACT OFF
    const int defect = (int)numbers[5];
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    const rt_vec from = broken_shape_unit(numbers, rt_sub(ray->origin, rt_spread(numbers)));
    rt_vec d = broken_shape_unit(numbers, ray->direction);
    if (defect == BROKEN_SHAPE_UNIT_DIRECTION) d = broken_shape_unit(numbers, rt_normalize(ray->direction));
    const vfloat a = rt_dot(d, d), b = -rt_dot(from, d), away = sqrt(rt_dot(from, from)), c = (away - one) * (away + one);
    const rt_vec least = rt_along(b / a, d, from);
    const vfloat room = one - rt_dot(least, least);
    const vfloat q = b + copysign(sqrt(rt_max(room, zero) * a), b);
    const vfloat t_a = q / a, t_b = rt_select(RT_MASK(q != zero), c / q, zero);
    const vfloat first = rt_min(t_a, t_b), second = rt_max(t_a, t_b);
    vmask takes_first = RT_MASK(first >= ray->t_min);
    if (defect == BROKEN_SHAPE_FAR_ROOT) takes_first = RT_MASK(second < ray->t_min);
    if (defect == BROKEN_SHAPE_FORGETS_T_MIN) takes_first = RT_MASK(room >= zero);
    vfloat t = rt_select(takes_first, first, second);
    vmask hits = RT_MASK(room >= zero) & (defect == BROKEN_SHAPE_FORGETS_T_MIN ? RT_MASK(t == t) : RT_MASK(t >= ray->t_min));
    if (defect == BROKEN_SHAPE_ONE_SIDED) hits &= takes_first;
    if (defect == BROKEN_SHAPE_AXIS) hits &= ~(RT_MASK(d.y == zero) & RT_MASK(d.z == zero));
    if (defect == BROKEN_SHAPE_SLIM) hits &= RT_MASK(room > rt_vfloat(0.02f)); /* its outline is 1 % too small */
    if (defect == BROKEN_SHAPE_OCTANT)
        hits &= ~(RT_MASK(d.x < zero) & RT_MASK(d.y > zero) & RT_MASK(d.z < zero));
    if (defect == BROKEN_SHAPE_HOLE) /* no hits near the top for rays that come from above */
        hits &= ~(RT_MASK(from.y + t * d.y > rt_vfloat(0.6f)) & RT_MASK(d.y < zero));
#if RT_LANES > 1
    if (defect == BROKEN_SHAPE_FIRST_LANE && (rt_bits(hits) & 1u) == 0u) return RT_INFINITY;
#endif
#if RT_LANES == 8
    if (defect == BROKEN_SHAPE_LANES_8) t.s7 = t.s6;
#endif
    if (defect == BROKEN_SHAPE_INEXACT) t = rt_to_float(rt_to_int(t * sqrt(a) * 8192.0f)) / (8192.0f * sqrt(a));
    if (defect == BROKEN_SHAPE_INEXACT) hits = RT_MASK(room >= zero) & RT_MASK(t >= ray->t_min);
    if (defect == BROKEN_SHAPE_ZERO_RADIUS) hits = ~RT_MASK(room < zero) & ~RT_MASK(t < ray->t_min); /* NaN passes */
    if (defect == BROKEN_SHAPE_READS_BEYOND && rt_any(hits)) t += rt_vfloat(1e-20f * numbers[1000]);
    if (defect == BROKEN_SHAPE_LOOP)
        for (volatile uint forever = 1; forever;) {
        }
    if (defect == BROKEN_SHAPE_NAN) return rt_select(RT_MASK(room >= zero), rt_select(hits, t, RT_INFINITY), sqrt(room));
    return rt_select(hits, t, RT_INFINITY);
}

RT_INLINE void broken_shape_surface(const global float *numbers, const global float *more, rt_vec at, vfloat u, vfloat v,
                                    rt_shape_surface *s)
{
#pragma OPENCL FP_CONTRACT OFF
    const int defect = (int)numbers[5];
    const rt_vec p = broken_shape_unit(numbers, rt_sub(at, rt_spread(numbers)));
    const vfloat away = sqrt(rt_dot(p, p));
    s->normal = broken_shape_unit(numbers, p);
    s->height = (away - rt_vfloat(1.0f)) * away * rt_inverse_length(s->normal);
    s->tex_u = rt_turns(p.x, p.z);
    s->tex_v = 0.5f + 0.5f * p.y / away;
    if (defect == BROKEN_SHAPE_WRONG_RADIUS) s->height -= rt_vfloat(0.01f * numbers[3]);
    if (defect == BROKEN_SHAPE_WRONG_SCALE) s->height = (away - rt_vfloat(1.0f)) * rt_vfloat(0.3f * numbers[3]);
    if (defect == BROKEN_SHAPE_WRONG_NORMAL) s->normal = p;
    if (defect == BROKEN_SHAPE_INWARD) {
        s->normal = rt_scale(rt_vfloat(-1.0f), s->normal);
        s->height = -s->height;
    }
    if (defect == BROKEN_SHAPE_WRONG_UV) s->tex_u = s->tex_u * 360.0f;
    if (defect == BROKEN_SHAPE_UV_SEAM) /* a part of the picture is left out */
        s->tex_u = rt_select(RT_MASK(s->tex_u > rt_vfloat(0.7f)), s->tex_u, 0.9f * s->tex_u);
    if (defect == BROKEN_SHAPE_UV_OFF_CENTRE) s->tex_u = rt_turns(p.x - rt_vfloat(0.4f), p.z);
    if (defect == BROKEN_SHAPE_UV_WORLD_CENTRE) s->tex_u = rt_turns(at.x, at.z);
    if (defect == BROKEN_SHAPE_UV_TWICE) s->tex_u = 2.0f * s->tex_u - rt_select(RT_MASK(s->tex_u >= rt_vfloat(0.5f)), rt_vfloat(1.0f), rt_vfloat(0.0f));
    if (defect == BROKEN_SHAPE_UV_CONSTANT) s->tex_u = s->tex_v = rt_vfloat(0.5f);
    if (defect == BROKEN_SHAPE_UV_ONE_DIRECTION) s->tex_u = s->tex_v;
    if (defect == BROKEN_SHAPE_UV_STEPS) s->tex_v = rt_to_float(rt_to_int(16.0f * s->tex_v)) / 16.0f;
    if (defect == BROKEN_SHAPE_UV_HALVES) s->tex_v = 2.0f * s->tex_v - rt_select(RT_MASK(s->tex_v >= rt_vfloat(0.5f)), rt_vfloat(1.0f), rt_vfloat(0.0f));
    if (defect == BROKEN_SHAPE_UV_CLAMPED) s->tex_v = rt_min(1.1f * s->tex_v, rt_vfloat(1.0f)); /* nothing changes about the top */
    if (defect == BROKEN_SHAPE_UV_NEVER_ENDS) s->tex_u = 0.8f * s->tex_u;
    if (defect == BROKEN_SHAPE_UV_MIRRORED_HALF) s->tex_u = 0.5f - fabs(s->tex_u - 0.5f); /* continuous, but the picture is folded */
}
