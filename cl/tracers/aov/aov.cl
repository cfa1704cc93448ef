/* aov.cl -- one quantity of what the camera rays hit, without shading: frame->aov.
 *
 * A quantity is a row of the host's table (host/view/settings/aov.cpp), from which RT_AOV_T, RT_AOV_PRIM and the like are defined.
 * With RT_COUNT_STEPS the program has those that are counted, else the others. out: 1 or 3 floats a pixel as the table says, top row
 * first. prim and instance are ints in the bits of floats. Steps, leaf tests and lanes are counted for the packet that the pixel's
 * ray belongs to. */
#if RT_AOV_COUNT != 9 /* those that this tracer makes */
#error "rt_store_aov() has no branch for the new AOV: add one, and count it here"
#endif

RT_INLINE void rt_store_aov(const rt_ctx *ctx, const constant rt_frame *frame, vint x, vint y, const rt_rays *ray, const rt_hits *hit,
                           uint bits, global float *out)
{
    const vint at = y * rt_vint((int)frame->width) + x;
#ifdef RT_COUNT_STEPS
    /* A packet that visits no node has no idle lane. */
    const float visited = (float)(hit->visits * popcount(bits));
    const float lanes = hit->visits != 0u ? (float)hit->lane_steps / visited : 1.0f;
    const float value = frame->aov == RT_AOV_STEPS        ? (float)hit->steps
                        : frame->aov == RT_AOV_BOXES      ? (float)(hit->boxes + hit->own_boxes)
                        : frame->aov == RT_AOV_LEAF_TESTS ? (float)hit->leaf_tests
                                                          : lanes;
    RT_FOR_LANES_STORE(out, at, rt_vfloat(value), bits)
#else
    if (frame->aov == RT_AOV_T) {
        RT_FOR_LANES_STORE(out, at, hit->t, bits)
        return;
    }
    rt_surface s = rt_resolve(ctx, ray, hit, bits);
    if (frame->aov == RT_AOV_PRIM || frame->aov == RT_AOV_INSTANCE) {
        RT_FOR_LANES_STORE(out, at, rt_as_vfloat(frame->aov == RT_AOV_PRIM ? s.prim : hit->instance), bits)
        return;
    }
    const bool normal = frame->aov == RT_AOV_NORMAL;
#if defined(RT_HAS_TANGENTS) && defined(RT_HAS_MAPS)
    if (normal) {
        RT_SPREAD_SURFACE(frame, &s, ray, hit->t * rt_vfloat(rt_pixel_angle(frame)))
        const vmask mapped = rt_map_normals(ctx, &s, bits & rt_bits(s.hit));
        s.geometric = rt_choose(mapped, s.normal, s.geometric);
    }
#endif
    const vint at3 = at * 3;
    RT_FOR_LANES_STORE(out, at3, normal ? s.geometric.x : s.tex_u, bits)
    RT_FOR_LANES_STORE(out, at3 + 1, normal ? s.geometric.y : s.tex_v, bits)
    RT_FOR_LANES_STORE(out, at3 + 2, normal ? s.geometric.z : rt_vfloat(0.0f), bits)
#endif
}

kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
trace_aov(const constant rt_frame *frame, RT_GROUPS_PARAMS global float *film, RT_OVERFLOWS_PARAM RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    const uint blocks = RT_BLOCKS(frame);
    RT_FOR_GROUPS(group)
    RT_FOR_PACKETS(frame, packet)
    RT_FOR_STREAMS(base, 0u, blocks) {
        const uint2 origin = rt_packet_origin(frame, group, packet);
        const uint count = RT_STREAM_OF(blocks - base);
        rt_rays rays[RT_STREAM];
        rt_hits hits[RT_STREAM];
        RT_FOR_EACH_PACKET(b, count) {
            vint in_x, in_y;
            const vmask active = rt_block_pixels(frame, origin, base + b, &in_x, &in_y);
            rt_camera_rays(frame, in_x + rt_vint((int)origin.x), in_y + rt_vint((int)origin.y), rays + b);
            RT_SEEN_BY(rays + b, rt_vint(RT_SEEN_BY_CAMERA))
            rt_prepare(rays + b, rt_bits(active));
            rt_clear_hits(hits + b, active);
        }
        rt_trace_stream_closest(&ctx, frame, rays, hits, count);
        RT_FOR_EACH_PACKET(b, count) {
            vint in_x, in_y;
            const vmask active = rt_block_pixels(frame, origin, base + b, &in_x, &in_y);
            const uint bits = rt_bits(active);
#ifdef RT_HAS_CUTOUTS
            uint dropped = 0; /* counted by pictures of colours */
            rt_pass_cutouts(&ctx, frame, 0, rt_vint(0), rays + b, hits + b, active, &dropped);
#endif
            RT_COUNT_OVERFLOW(hits + b)
            if (bits != 0u) rt_store_aov(&ctx, frame, in_x + rt_vint((int)origin.x), in_y + rt_vint((int)origin.y), rays + b, hits + b, bits, film);
        }
    }
}
