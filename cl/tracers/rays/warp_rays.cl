/* warp_rays.cl -- traces the host's rays on a GPU: one way through the tree for all rays of a warp.
 *
 * Guenther, Popov, Seidel, Slusallek 2007, "Realtime Ray Tracing on GPU with BVH-based Packet Traversal". Coherent rays
 * together visit hardly more nodes than the longest of them alone, and each decision is made once for all. Incoherent rays are
 * three to five times slower.
 *
 * On NVIDIA's devices the work-items of a warp decide by votes (subgroup.h); elsewhere each work-item is traced by itself. A
 * work-item has RT_RAYS_PER_ITEM rays, RT_SUBGROUP_SIZE apart in memory: with two, a fetch serves 64 rays. Rays are traced
 * class after class. Hits do not depend on the order of visits, so answers are bit for bit those of rays.cl. */

/* The class of a ray: bits 0 to 2 are the signs of its direction, the bits from 3 on its dominant axis. */
#define RT_NO_RAY_CLASS 24u
RT_INLINE uint rt_ray_class(const rt_rays *ray)
{
    return (ray->ix < 0.0f ? 1u : 0u) | (ray->iy < 0.0f ? 2u : 0u) | (ray->iz < 0.0f ? 4u : 0u) | ray->kz << 3;
}

RT_INLINE void rt_trace_warp(const rt_ctx *ctx, const constant rt_frame *frame, uint any_hit, rt_rays *rays, rt_hits *hits)
{
    uint ray_class[RT_RAYS_PER_ITEM]; /* RT_NO_RAY_CLASS once the ray is traced */
    float reach[RT_RAYS_PER_ITEM];
    RT_FOR_EACH_RAY_OF_ITEM(i) {
        reach[i] = hits[i].t;
        ray_class[i] = reach[i] < 0.0f ? RT_NO_RAY_CLASS : rt_ray_class(rays + i);
    }
    for (;;) {
        uint next_class = RT_NO_RAY_CLASS;
        RT_FOR_EACH_RAY_OF_ITEM(i) next_class = min(next_class, ray_class[i]);
        const uint untraced = rt_subgroup_ballot(next_class < RT_NO_RAY_CLASS);
        if (untraced == 0u) break;
        const uint traced_class = rt_subgroup_broadcast(31u - clz(untraced), next_class);
        RT_FOR_EACH_RAY_OF_ITEM(i) {
            hits[i].t = ray_class[i] == traced_class ? reach[i] : -1.0f;
            rays[i].kz = traced_class >> 3;
        }
        if (any_hit)
            rt_scene_warp_any(ctx, frame->root, traced_class & 7u, rays, hits);
        else
            rt_scene_warp_closest(ctx, frame->root, traced_class & 7u, rays, hits);
        RT_FOR_EACH_RAY_OF_ITEM(i) {
            if (ray_class[i] != traced_class) continue;
            reach[i] = hits[i].t;
            ray_class[i] = RT_NO_RAY_CLASS;
        }
    }
    RT_FOR_EACH_RAY_OF_ITEM(i) hits[i].t = reach[i];
}

kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
trace_warps(const constant rt_frame *frame, const uint first_group, const uint count, const uint any_hit,
            const uint fields, const uint stride, const uint before,
            const global float *rays, global float *answers, RT_OVERFLOWS_PARAM RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    const uint warp = (first_group + (uint)get_group_id(0)) * (RT_LOCAL_SIZE / RT_SUBGROUP_SIZE) + (uint)get_local_id(0) / RT_SUBGROUP_SIZE;
    const uint first = warp * (RT_SUBGROUP_SIZE * RT_RAYS_PER_ITEM) + rt_subgroup_local_id();
    rt_rays ray[RT_RAYS_PER_ITEM];
    rt_hits hit[RT_RAYS_PER_ITEM];
    bool active[RT_RAYS_PER_ITEM];
    RT_FOR_EACH_RAY_OF_ITEM(i) {
        const uint at = first + i * RT_SUBGROUP_SIZE;
        float t_max;
        rt_load_ray_block(frame, rays, min(at, count - 1u), ray + i, &t_max); /* every work-item must take part in votes */
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
    RT_FOR_EACH_RAY_OF_ITEM(i) {
        const uint at = first + i * RT_SUBGROUP_SIZE;
        if (at >= count) continue;
        RT_COUNT_OVERFLOW(hit + i)
        if (any_hit)
            hit[i].t = active[i] && hit[i].t < 0.0f ? 0.0f : INFINITY;
        else
            hit[i].t = hit[i].prim >= 0 ? hit[i].t * rt_scale_of_block(rays, at) : INFINITY;
        rt_store_hit_block(answers, at, fields, stride, before, hit + i);
    }
}
