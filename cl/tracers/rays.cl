/* rays.cl -- rays that the host brings, in groups of RT_LANES: for tests and benches. */
kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
trace_rays(const constant rt_frame *frame, const uint first_group, const uint count, const uint any_hit,
           const global rt_ray *rays, global rt_hit *hits, RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    RT_FOR_PACKETS(packet)
    {
        const uint item = (first_group + (uint)get_group_id(0)) * (RT_GROUP_W * RT_GROUP_H) + packet;
        const uint first = item * RT_LANES;
        if (first >= count) return;

        float fields[8][RT_LANES];
        for (uint l = 0; l < RT_LANES; ++l) {
            const rt_ray ray = rays[min(first + l, count - 1u)];
            for (uint k = 0; k < 3; ++k) {
                fields[k][l] = ray.origin[k];
                fields[4 + k][l] = ray.direction[k];
            }
            fields[3][l] = ray.t_min;
            fields[7][l] = ray.t_max;
        }
        const vmask active = RT_MASK(rt_lane_index() < rt_vint((int)(count - first)));
        const uint bits = rt_bits(active);
        rt_rays ray;
        rt_hits hit;
        ray.ox = rt_load(fields[0]);
        ray.oy = rt_load(fields[1]);
        ray.oz = rt_load(fields[2]);
        ray.t_min = rt_load(fields[3]);
        ray.dx = rt_load(fields[4]);
        ray.dy = rt_load(fields[5]);
        ray.dz = rt_load(fields[6]);
        rt_prepare(&ray, bits);
        rt_clear_hits(&hit, active);
        const vfloat t_max = rt_load(fields[7]);
        hit.t = rt_select(active, t_max, hit.t);
        vint prim = rt_vint(-1);
        if (any_hit) {
            rt_trace_any(&ctx, frame, &ray, &hit);
            hit.t = rt_select(RT_MASK(hit.t < rt_vfloat(0.0f)), rt_vfloat(0.0f), RT_INFINITY);
        } else {
            rt_trace_closest(&ctx, frame, &ray, &hit);
            prim = rt_resolve(&ctx, &ray, &hit, bits).prim;
            hit.t = rt_select(RT_MASK(prim >= rt_vint(0)), hit.t, RT_INFINITY);
        }

        float t[RT_LANES], u[RT_LANES], v[RT_LANES];
        int prims[RT_LANES], instances[RT_LANES];
        rt_store(hit.t, t);
        rt_store(hit.u, u);
        rt_store(hit.v, v);
        rt_store(prim, prims);
        rt_store(hit.instance, instances);
        for (uint l = 0; l < RT_LANES && first + l < count; ++l) {
            global rt_hit *out = hits + first + l;
            out->t = t[l];
            out->u = u[l];
            out->v = v[l];
            out->prim = prims[l];
            out->instance = instances[l];
#ifdef RT_COUNT_STEPS
            out->steps = hit.steps;
            out->leaf_tests = hit.leaf_tests;
            out->lane_steps = hit.lane_steps;
#else
            out->steps = out->leaf_tests = out->lane_steps = 0u;
#endif
        }
    }
}
