/* shape_single_ray.h -- calls the kernels of plugins with RT_SHAPE_SINGLE_RAY for one lane after the other. The macros stand in
 * rt_shape_hit() and rt_shape_surface_at(), which the host writes, and end them. */
#ifndef RT_SHAPE_SINGLE_RAY_H
#define RT_SHAPE_SINGLE_RAY_H
#define RT_LANE_OF(value, l) (((const float *)&(value))[l])
#define RT_LANES_OF(vec, l) (float3)(RT_LANE_OF((vec).x, l), RT_LANE_OF((vec).y, l), RT_LANE_OF((vec).z, l))

#define RT_SHAPE_HIT_EACH(hit)                                                                                                 \
    {                                                                                                                          \
        float ts[RT_LANES], us[RT_LANES], vs[RT_LANES];                                                                        \
        rt_store(RT_INFINITY, ts);                                                                                             \
        rt_store(rt_vfloat(0.0f), us);                                                                                         \
        rt_store(rt_vfloat(0.0f), vs);                                                                                         \
        for (; bits != 0u; bits &= bits - 1u) {                                                                                \
            const uint l = rt_lowest(bits);                                                                                    \
            rt_shape_ray single;                                                                                               \
            single.origin = RT_LANES_OF(ray->origin, l);                                                                       \
            single.direction = RT_LANES_OF(ray->direction, l);                                                                 \
            single.t_min = RT_LANE_OF(ray->t_min, l);                                                                          \
            single.t_max = RT_LANE_OF(ray->t_max, l);                                                                          \
            ts[l] = hit(numbers, more, &single, us + l, vs + l);                                                               \
        }                                                                                                                      \
        *u = rt_load(us);                                                                                                      \
        *v = rt_load(vs);                                                                                                      \
        return rt_load(ts);                                                                                                    \
    }

#define RT_SHAPE_SURFACE_EACH(surface)                                                                                         \
    {                                                                                                                          \
        float nx[RT_LANES], ny[RT_LANES], nz[RT_LANES], height[RT_LANES], error[RT_LANES], tex_u[RT_LANES], tex_v[RT_LANES];   \
        rt_store(rt_vfloat(1.0f), nx);                                                                                         \
        rt_store(rt_vfloat(0.0f), ny);                                                                                         \
        rt_store(rt_vfloat(0.0f), nz);                                                                                         \
        rt_store(rt_vfloat(0.0f), height);                                                                                     \
        rt_store(s->error, error);                                                                                             \
        rt_store(rt_vfloat(0.0f), tex_u);                                                                                      \
        rt_store(rt_vfloat(0.0f), tex_v);                                                                                      \
        for (; bits != 0u; bits &= bits - 1u) {                                                                                \
            const uint l = rt_lowest(bits);                                                                                    \
            rt_shape_point point;                                                                                              \
            point.error = error[l];                                                                                            \
            point.tex_u = point.tex_v = 0.0f;                                                                                  \
            point.wants_uv = s->wants_uv;                                                                                      \
            surface(numbers, more, RT_LANES_OF(at, l), RT_LANE_OF(u, l), RT_LANE_OF(v, l), &point);                            \
            nx[l] = point.normal.x, ny[l] = point.normal.y, nz[l] = point.normal.z;                                            \
            height[l] = point.height, error[l] = point.error, tex_u[l] = point.tex_u, tex_v[l] = point.tex_v;                  \
        }                                                                                                                      \
        s->normal = rt_vec_of(rt_load(nx), rt_load(ny), rt_load(nz));                                                          \
        s->height = rt_load(height);                                                                                           \
        s->error = rt_load(error);                                                                                             \
        s->tex_u = rt_load(tex_u);                                                                                             \
        s->tex_v = rt_load(tex_v);                                                                                             \
        return;                                                                                                                \
    }
#endif
