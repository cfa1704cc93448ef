/* all_hits.cl -- all hits of the host's rays, RT_ALL_HITS of each at a time, a block of RT_LANES rays after the other. ray_blocks.h has
 * the layout of rays. Those of `after` are t and prim of the last hit that the host has of each ray; those of answers t, u, v, prim,
 * instance of each place of a list, the nearest hit first. */
kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
trace_all_hits(const constant rt_frame *frame, RT_GROUPS_PARAMS const uint blocks, const global float *rays,
               const global float *after, global float *answers, RT_OVERFLOWS_PARAM RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    const uint packet_blocks = RT_BLOCKS(frame);
    RT_FOR_GROUPS(group)
    RT_FOR_PACKETS(frame, packet)
    {
        const uint first = (group * RT_GROUP_PACKETS(frame) + packet) * packet_blocks, end = min(first + packet_blocks, blocks);
        for (uint b = first; b < end; ++b) {
            rt_rays ray;
            rt_hits hit;
            rt_hit_list list;
            vfloat t_max;
            rt_load_ray_block(frame, rays, b, &ray, &t_max);
            const vfloat scale = rt_scale_of_block(rays, b);
            const vmask active = RT_MASK(t_max >= rt_vfloat(0.0f));
            const global vfloat *last = (const global vfloat *)after + 2u * (size_t)b;
            rt_clear_hits(&hit, active);
            hit.t = rt_select(active, t_max, rt_vfloat(-1.0f));
            hit.list = &list;
            rt_clear_list(&list, hit.t, last[0] * RT_INVERSE_POWER(scale), rt_as_vint(last[1]));
            if (rt_any(active)) {
                rt_prepare(&ray, rt_bits(active));
                rt_trace_closest(&ctx, frame, &ray, &hit);
            }
            RT_COUNT_OVERFLOW(&hit)
            global vfloat *out = (global vfloat *)answers + RT_LIST_FIELDS * RT_ALL_HITS * (size_t)b;
            for (uint i = 0; i < RT_ALL_HITS; ++i, out += RT_LIST_FIELDS) {
                out[0] = list.t[i] * scale;
                out[1] = list.u[i];
                out[2] = list.v[i];
                out[3] = rt_as_vfloat(rt_select(active, list.prim[i], rt_vint(-1)));
                out[4] = rt_as_vfloat(list.instance[i]);
            }
        }
    }
}
