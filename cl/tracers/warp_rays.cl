/* warp_rays.cl -- rays that the host brings, for single rays on a GPU: one way through the tree for all rays of a warp (Guenther,
 * Popov, Seidel, Slusallek 2007, "Realtime Ray Tracing on GPU with BVH-based Packet Traversal"). Where rays keep together they meet
 * hardly more nodes than the longest of them alone, and what is decided is decided once for all. Rays that part lose by it, three
 * to five times.
 *
 * On NVIDIA's devices a warp agrees by votes (vote.h), elsewhere each work-item goes by itself. It has RT_EACH rays, RT_VOTERS apart
 * in memory: with two, what is fetched serves 64 rays. Rays whose directions differ in sign or in dominant axis go one after
 * the other. Answers are those of rays.cl bit for bit, for hits do not depend on the order of visits. */

/* A ray's bearing: where its direction is negative, bits 0 to 2, and from bit 3 on its dominant axis. */
#define RT_NO_BEARING 24u
RT_INLINE uint rt_bearing(const rt_rays *ray)
{
    return (ray->ix < 0.0f ? 1u : 0u) | (ray->iy < 0.0f ? 2u : 0u) | (ray->iz < 0.0f ? 4u : 0u) | ray->kz << 3;
}

RT_INLINE void rt_trace_warp(const rt_ctx *ctx, const constant rt_frame *frame, uint any_hit, rt_rays *rays, rt_hits *hits)
{
    uint bearing[RT_EACH]; /* of those that still have to go */
    float reach[RT_EACH];
    RT_FOR_EACH_OWN(i) {
        reach[i] = hits[i].t;
        bearing[i] = reach[i] < 0.0f ? RT_NO_BEARING : rt_bearing(rays + i);
    }
    for (;;) {
        uint own = RT_NO_BEARING;
        RT_FOR_EACH_OWN(i) own = min(own, bearing[i]);
        const uint waiting = rt_ballot(own < RT_NO_BEARING);
        if (waiting == 0u) break;
        const uint now = rt_value_of(31u - clz(waiting), own);
        RT_FOR_EACH_OWN(i) {
            hits[i].t = bearing[i] == now ? reach[i] : -1.0f;
            rays[i].kz = now >> 3;
        }
        if (any_hit)
            rt_scene_warp_any(ctx, frame->root, now & 7u, rays, hits);
        else
            rt_scene_warp_closest(ctx, frame->root, now & 7u, rays, hits);
        RT_FOR_EACH_OWN(i) {
            if (bearing[i] != now) continue;
            reach[i] = hits[i].t;
            bearing[i] = RT_NO_BEARING;
        }
    }
    RT_FOR_EACH_OWN(i) hits[i].t = reach[i];
}

kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
trace_warps(const constant rt_frame *frame, const uint first_group, const uint count, const uint any_hit, const uint fields,
            const global float *rays, global float *answers, RT_OVERFLOWS_PARAM RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    const uint warp = (first_group + (uint)get_group_id(0)) * (RT_LOCAL_SIZE / RT_VOTERS) + (uint)get_local_id(0) / RT_VOTERS;
    const uint first = warp * (RT_VOTERS * RT_EACH) + rt_voter();
    rt_rays ray[RT_EACH];
    rt_hits hit[RT_EACH];
    bool active[RT_EACH];
    RT_FOR_EACH_OWN(i) {
        const uint at = first + i * RT_VOTERS;
        float t_max;
        rt_load_ray_block(rays, min(at, count - 1u), ray + i, &t_max); /* nobody may stay away from a vote */
        active[i] = at < count && t_max >= 0.0f;
        rt_clear_hits(hit + i, -1);
        hit[i].t = active[i] ? t_max : -1.0f;
        rt_prepare(ray + i, 1u);
#if RT_HAS_PLANES
        if (!active[i]) continue;
        if (any_hit)
            rt_hit_planes_any(&ctx, frame->plane_count, ray + i, hit + i);
        else
            rt_hit_planes_closest(&ctx, frame->plane_count, ray + i, hit + i);
#endif
    }
    rt_trace_warp(&ctx, frame, any_hit, ray, hit);
    RT_FOR_EACH_OWN(i) {
        const uint at = first + i * RT_VOTERS;
        if (at >= count) continue;
        RT_COUNT_OVERFLOW(hit + i)
        if (any_hit)
            hit[i].t = active[i] && hit[i].t < 0.0f ? 0.0f : INFINITY;
        else
            hit[i].t = hit[i].prim >= 0 ? hit[i].t : INFINITY;
        rt_store_hit_block(answers, at, fields, hit + i);
    }
}
