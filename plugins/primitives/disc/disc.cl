/* disc.cl -- the ray's point in the disc's plane, and its distance from the centre. numbers: centre, unit normal, radius, radius of
 * the hole. */
RT_INLINE rt_vec disc_from_center(const global float *numbers, rt_vec at) { return rt_sub(at, rt_spread(numbers)); }

RT_INLINE vfloat disc_hit(const global float *numbers, const global float *more, const rt_shape_rays *ray, vfloat *u, vfloat *v)
{
#pragma OPENCL FP_CONTRACT OFF
    const rt_vec normal = rt_spread(numbers + 3), from = disc_from_center(numbers, ray->origin);
    const vfloat facing = rt_dot(normal, ray->direction), t = -rt_dot(normal, from) / facing;
    const rt_vec at = rt_along(t, ray->direction, from);
    const vfloat away = rt_dot(at, at), outer = rt_vfloat(numbers[6] * numbers[6]), inner = rt_vfloat(numbers[7] * numbers[7]);
    const vmask hits = RT_MASK(facing != rt_vfloat(0.0f)) & RT_MASK(away <= outer) & RT_MASK(away >= inner) & RT_MASK(t >= ray->t_min);
    return rt_select(hits, t, RT_INFINITY);
}

RT_INLINE void disc_surface(const global float *numbers, const global float *more, rt_vec at, vfloat u, vfloat v, rt_shape_surface *s)
{
#pragma OPENCL FP_CONTRACT OFF
    const rt_vec from = disc_from_center(numbers, at);
    s->normal = rt_spread(numbers + 3);
    s->height = rt_dot(s->normal, from);
    if (!s->wants_uv) return;
    rt_vec x, y;
    rt_across(numbers + 3, &x, &y);
    s->tex_u = rt_turns(rt_dot(from, x), rt_dot(from, y));
    s->tex_v = sqrt(rt_dot(from, from)) / rt_vfloat(numbers[6]);
}
