/* rays.cl -- rays that the host brings, a block of RT_LANES at a time: for tests and benches. Memory: ray_blocks.h. */
kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
trace_rays(const constant rt_frame *frame, const uint first_group, const uint blocks, const uint any_hit, const uint fields,
           const global float *rays, global float *answers, RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    RT_FOR_PACKETS(packet)
    {
        const uint block = (first_group + (uint)get_group_id(0)) * (RT_GROUP_W * RT_GROUP_H) + packet;
        if (block >= blocks) return;

        rt_rays ray;
        rt_hits hit;
        vfloat t_max;
        rt_load_ray_block(rays, block, &ray, &t_max);
        const vmask active = RT_MASK(t_max >= rt_vfloat(0.0f));
        const uint bits = rt_bits(active);
        rt_clear_hits(&hit, active);
        hit.t = rt_select(active, t_max, hit.t);
        if (bits != 0u) {
            rt_prepare(&ray, bits);
            if (any_hit)
                rt_trace_any(&ctx, frame, &ray, &hit);
            else
                rt_trace_closest(&ctx, frame, &ray, &hit);
        }
        if (any_hit) {
            hit.t = rt_select(active & RT_MASK(hit.t < rt_vfloat(0.0f)), rt_vfloat(0.0f), RT_INFINITY);
        } else {
            hit.t = rt_select(RT_MASK(hit.prim >= rt_vint(0)), hit.t, RT_INFINITY);
        }
        rt_store_hit_block(answers, block, fields, &hit);
    }
}
