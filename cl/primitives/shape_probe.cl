/* shape_probe.cl -- what the two functions of one shape answer, without scene and structure. For `clarity check`, which writes
 * probe_hit() and probe_surface() from the plugin's id. Each work-item takes RT_LANES rays or points. */

/* Loads field k of the lanes' records of `stride` floats. Lanes beyond the end get the last record. */
#define RT_PROBE_LOAD(out, buffer, stride, k)                                                                                  \
    {                                                                                                                          \
        float values[RT_LANES];                                                                                                \
        for (uint l = 0; l < RT_LANES; ++l) values[l] = (buffer)[(stride)*min(first + l, count - 1u) + (k)];                   \
        out = rt_load(values);                                                                                                 \
    }
#define RT_PROBE_STORE(buffer, stride, k, value)                                                                               \
    {                                                                                                                          \
        float values[RT_LANES];                                                                                                \
        rt_store(value, values);                                                                                               \
        for (uint l = 0; l < RT_LANES; ++l)                                                                                    \
            if (first + l < count) (buffer)[(stride) * (first + l) + (k)] = values[l];                                         \
    }
#define RT_PROBE_BEGIN                                                                                                         \
    const uint first = (uint)get_global_id(0) * RT_LANES;                                                                      \
    uint bits = 0;                                                                                                             \
    for (uint l = 0; l < RT_LANES; ++l)                                                                                        \
        if (first + l < count) bits |= 1u << l;

/* rays: rt_ray. answers: t, u, v. */
kernel void probe_hits(const global float *numbers, const global float *more, const global float *rays, global float *answers, uint count)
{
    RT_PROBE_BEGIN
    rt_shape_rays ray;
    RT_PROBE_LOAD(ray.origin.x, rays, 8u, 0u)
    RT_PROBE_LOAD(ray.origin.y, rays, 8u, 1u)
    RT_PROBE_LOAD(ray.origin.z, rays, 8u, 2u)
    RT_PROBE_LOAD(ray.t_min, rays, 8u, 3u)
    RT_PROBE_LOAD(ray.direction.x, rays, 8u, 4u)
    RT_PROBE_LOAD(ray.direction.y, rays, 8u, 5u)
    RT_PROBE_LOAD(ray.direction.z, rays, 8u, 6u)
    RT_PROBE_LOAD(ray.t_max, rays, 8u, 7u)
    vfloat u = rt_vfloat(0.0f), v = u;
    const vfloat t = probe_hit(numbers, more, &ray, bits, &u, &v);
    RT_PROBE_STORE(answers, 3u, 0u, t)
    RT_PROBE_STORE(answers, 3u, 1u, u)
    RT_PROBE_STORE(answers, 3u, 2u, v)
}

/* points: x, y, z, u, v. answers: normal, height, error, tex_u, tex_v. error: what the host sets beforehand. */
kernel void probe_surfaces(const global float *numbers, const global float *more, const global float *points, global float *answers,
                           uint count, float error)
{
    RT_PROBE_BEGIN
    rt_vec at;
    vfloat u, v;
    RT_PROBE_LOAD(at.x, points, 5u, 0u)
    RT_PROBE_LOAD(at.y, points, 5u, 1u)
    RT_PROBE_LOAD(at.z, points, 5u, 2u)
    RT_PROBE_LOAD(u, points, 5u, 3u)
    RT_PROBE_LOAD(v, points, 5u, 4u)
    rt_shape_surface s;
    s.error = rt_vfloat(error);
    s.height = s.tex_u = s.tex_v = rt_vfloat(0.0f);
    s.normal = rt_splat(1.0f, 0.0f, 0.0f);
    s.wants_uv = 1;
    probe_surface(numbers, more, at, u, v, bits, &s);
    RT_PROBE_STORE(answers, 7u, 0u, s.normal.x)
    RT_PROBE_STORE(answers, 7u, 1u, s.normal.y)
    RT_PROBE_STORE(answers, 7u, 2u, s.normal.z)
    RT_PROBE_STORE(answers, 7u, 3u, s.height)
    RT_PROBE_STORE(answers, 7u, 4u, s.error)
    RT_PROBE_STORE(answers, 7u, 5u, s.tex_u)
    RT_PROBE_STORE(answers, 7u, 6u, s.tex_v)
}
