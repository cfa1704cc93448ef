/* rays.cl -- traces the host's rays, a block of RT_LANES at a time, for queries, tests and benchmarks. ray_blocks.h has their
 * layout. */
kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
trace_rays(const constant rt_frame *frame, RT_GROUPS_PARAMS const uint blocks, const uint any_hit,
           const uint fields, const uint stride, const uint before,
           const global float *rays, global float *answers, RT_OVERFLOWS_PARAM RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    const uint packet_blocks = RT_BLOCKS(frame);
    RT_FOR_GROUPS(group)
    RT_FOR_PACKETS(frame, packet)
    {
        const uint first = (group * RT_GROUP_PACKETS(frame) + packet) * packet_blocks, end = min(first + packet_blocks, blocks);
        RT_FOR_STREAMS(base, first, end) {
            const uint count = RT_STREAM_OF(end - base);
            rt_rays ray[RT_STREAM];
            rt_hits hit[RT_STREAM];
            vmask active[RT_STREAM];
            RT_FOR_EACH_PACKET(b, count) {
                rt_fetch_ahead(rays, base + b, blocks - 1u);
                vfloat t_max;
#if RT_LANES == 1 /* one load has all fields */
                rt_load_ray_block(frame, rays, base + b, ray + b, &t_max);
#else
                t_max = rt_load_reach(rays, base + b);
#endif
                active[b] = RT_MASK(t_max >= rt_vfloat(0.0f));
                if (RT_STREAM == 1) rt_clear_hits(hit + b, active[b]); /* a stream answers blocks without rays apart */
                hit[b].t = rt_vfloat(-1.0f);
                RT_CLEAR_OVERFLOW(hit + b)
                RT_GRANT_PUSHES(hit + b, base + b)
                if (!rt_any(active[b])) continue;
#if RT_LANES > 1
                rt_load_ray_block(frame, rays, base + b, ray + b, &t_max);
                active[b] &= RT_MASK(t_max >= rt_vfloat(0.0f));
                if (!rt_any(active[b])) continue;
#endif
                rt_prepare_for_boxes(ray + b);
                /* Skips packets that miss the scene: where few rays hit anything, a stream spends most of its time on preparing
                 * them. Programs that count do not, so that their counts begin at the tree's root. */
#if RT_STREAM > 1 && !RT_HAS_PLANES && !defined(RT_COUNT_STEPS)
                active[b] &= rt_enter_scene(frame, ray + b, t_max);
                if (!rt_any(active[b])) continue;
#endif
                rt_prepare_for_triangles(ray + b, rt_bits(active[b]));
                if (RT_STREAM > 1) rt_clear_hits(hit + b, active[b]);
                hit[b].t = rt_select(active[b], t_max, rt_vfloat(-1.0f));
            }
            if (any_hit)
                rt_trace_stream_any(&ctx, frame, ray, hit, count);
            else
                rt_trace_stream_closest(&ctx, frame, ray, hit, count);
            RT_FOR_EACH_PACKET(b, count) {
                RT_COUNT_OVERFLOW(hit + b)
                if (RT_STREAM > 1 && !rt_any(active[b])) { /* most blocks, where rays hit little */
                    rt_hits none;
                    rt_clear_hits(&none, active[b]);
                    none.t = RT_INFINITY;
                    rt_store_hit_block(answers, base + b, fields, stride, before, &none);
                    continue;
                }
                if (any_hit)
                    hit[b].t = rt_select(active[b] & RT_MASK(hit[b].t < rt_vfloat(0.0f)), rt_vfloat(0.0f), RT_INFINITY);
                else
                    hit[b].t = rt_select(RT_MASK(hit[b].prim >= rt_vint(0)), hit[b].t * rt_scale_of_block(rays, base + b), RT_INFINITY);
                rt_store_hit_block(answers, base + b, fields, stride, before, hit + b);
            }
        }
    }
}
