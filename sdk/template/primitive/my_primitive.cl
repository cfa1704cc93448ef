/* my_primitive.cl -- an ellipsoid. Divided by its radii, it is a sphere of radius 1 around the origin. Each call computes all lanes of a
 * packet, see CONTRACT.md. numbers: those of the keys, centre and radii. */
RT_INLINE rt_vec my_primitive_by_radii(const global float *numbers, rt_vec v)
{
    return rt_vec_of(v.x / rt_vfloat(numbers[3]), v.y / rt_vfloat(numbers[4]), v.z / rt_vfloat(numbers[5]));
}

/* The nearest hit that is not below t_min. */
RT_INLINE vfloat my_primitive_hit(const global float *numbers, const global float *more, const rt_shape_rays *ray, vfloat *u, vfloat *v)
{
#pragma OPENCL FP_CONTRACT OFF
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    const rt_vec from = my_primitive_by_radii(numbers, rt_sub(ray->origin, rt_spread(numbers)));
    const rt_vec d = my_primitive_by_radii(numbers, ray->direction);
    /* a t^2 - 2 b t + c = 0. Whether there is a root is decided at the ray's point next to the centre, where nothing cancels. */
    const vfloat a = rt_dot(d, d), b = -rt_dot(from, d), away = sqrt(rt_dot(from, from)), c = (away - one) * (away + one);
    const rt_vec least = rt_along(b / a, d, from);
    const vfloat room = one - rt_dot(least, least);
    const vfloat q = b + copysign(sqrt(rt_max(room, zero) * a), b);
    const vfloat t_a = q / a, t_b = rt_select(RT_MASK(q != zero), c / q, zero);
    const vfloat first = rt_min(t_a, t_b), second = rt_max(t_a, t_b);
    const vfloat t = rt_select(RT_MASK(first >= ray->t_min), first, second);
    return rt_select(RT_MASK(room >= zero) & RT_MASK(t >= ray->t_min), t, RT_INFINITY);
}

/* The surface at a hit. */
RT_INLINE void my_primitive_surface(const global float *numbers, const global float *more, rt_vec at, vfloat u, vfloat v,
                                    rt_shape_surface *s)
{
#pragma OPENCL FP_CONTRACT OFF
    const rt_vec p = my_primitive_by_radii(numbers, rt_sub(at, rt_spread(numbers)));
    const vfloat away = sqrt(rt_dot(p, p));
    s->normal = my_primitive_by_radii(numbers, p); /* times 1 / away, it is the gradient of `away` */
    s->height = (away - rt_vfloat(1.0f)) * away * rt_inverse_length(s->normal);
    if (!s->wants_uv) return;
    s->tex_u = rt_turns(p.x, p.z);
    s->tex_v = 0.5f + 0.5f * p.y / away;
}
