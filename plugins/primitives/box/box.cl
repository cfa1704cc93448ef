/* box.cl -- ray/box by slabs (Kay, Kajiya 1986, "Ray Tracing Complex Scenes"). numbers: two opposite corners. u: number of the face,
 * twice the axis, and 1 for the upper one. */

/* Cuts the ray with the slab of one axis. */
RT_INLINE void box_slab(float from, float to, vfloat origin, vfloat direction, float face, vfloat *in, vfloat *in_face, vfloat *out,
                        vfloat *out_face)
{
    const vfloat inverse = rt_safe_reciprocal(direction);
    const vfloat lower = (rt_vfloat(min(from, to)) - origin) * inverse, upper = (rt_vfloat(max(from, to)) - origin) * inverse;
    const vmask back = RT_MASK(inverse < rt_vfloat(0.0f));
    const vfloat low = rt_vfloat(face), high = rt_vfloat(face + 1.0f);
    const vfloat nearer = rt_select(back, upper, lower), farther = rt_select(back, lower, upper);
    const vmask later = RT_MASK(nearer > *in), earlier = RT_MASK(farther < *out);
    *in = rt_select(later, nearer, *in);
    *in_face = rt_select(later, rt_select(back, high, low), *in_face);
    *out = rt_select(earlier, farther, *out);
    *out_face = rt_select(earlier, rt_select(back, low, high), *out_face);
}

RT_INLINE vfloat box_hit(const global float *numbers, const global float *more, const rt_shape_rays *ray, vfloat *u, vfloat *v)
{
#pragma OPENCL FP_CONTRACT OFF
    vfloat in = -RT_INFINITY, out = RT_INFINITY, in_face = rt_vfloat(0.0f), out_face = rt_vfloat(0.0f);
    box_slab(numbers[0], numbers[3], ray->origin.x, ray->direction.x, 0.0f, &in, &in_face, &out, &out_face);
    box_slab(numbers[1], numbers[4], ray->origin.y, ray->direction.y, 2.0f, &in, &in_face, &out, &out_face);
    box_slab(numbers[2], numbers[5], ray->origin.z, ray->direction.z, 4.0f, &in, &in_face, &out, &out_face);
    const vmask from_outside = RT_MASK(in >= ray->t_min);
    const vfloat t = rt_select(from_outside, in, out);
    *u = rt_select(from_outside, in_face, out_face);
    return rt_select(RT_MASK(in <= out) & RT_MASK(t >= ray->t_min), t, RT_INFINITY);
}

/* Where a number is between two others: 0 to 1. */
RT_INLINE vfloat box_share(float from, float to, vfloat x) { return (x - rt_vfloat(min(from, to))) / rt_vfloat(fabs(to - from)); }

RT_INLINE void box_surface(const global float *numbers, const global float *more, rt_vec at, vfloat u, vfloat v, rt_shape_surface *s)
{
#pragma OPENCL FP_CONTRACT OFF
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    const vmask is_x = RT_MASK(u < rt_vfloat(1.5f)), is_y = RT_MASK(u < rt_vfloat(3.5f)) & ~is_x, is_z = ~(is_x | is_y);
    const vfloat first = rt_select(is_x, zero, rt_select(is_y, rt_vfloat(2.0f), rt_vfloat(4.0f)));
    const vmask upper = RT_MASK(u > first + rt_vfloat(0.5f));
    const vfloat side = rt_select(upper, one, -one);
    s->normal = rt_vec_of(rt_select(is_x, side, zero), rt_select(is_y, side, zero), rt_select(is_z, side, zero));
    const rt_vec lower = rt_splat(min(numbers[0], numbers[3]), min(numbers[1], numbers[4]), min(numbers[2], numbers[5]));
    const rt_vec higher = rt_splat(max(numbers[0], numbers[3]), max(numbers[1], numbers[4]), max(numbers[2], numbers[5]));
    const rt_vec above = rt_choose(upper, rt_sub(at, higher), rt_sub(lower, at));
    s->height = rt_select(is_x, above.x, rt_select(is_y, above.y, above.z));
    const vfloat x = box_share(numbers[0], numbers[3], at.x), y = box_share(numbers[1], numbers[4], at.y),
                 z = box_share(numbers[2], numbers[5], at.z);
    s->tex_u = rt_select(is_x, z, x);
    s->tex_v = rt_select(is_y, z, y);
}
