/* spread_packet.h -- traces the active lanes of a packet one after the other by a traversal of one ray. A template, see
 * CONTRACT.md. */
RT_INLINE void RT_TRAVERSE_PACKET(const rt_ctx *ctx, uint root, const rt_rays *rays, rt_hits *hits)
{
#ifdef RT_TRAVERSES_PACKETS
    if (RT_CAT(RT_TRAVERSE, _packet)(ctx, root, rays, hits)) return;
#endif
    rt_single_rays ray_lanes;
    rt_single_hits hit_lanes;
    rt_spread_rays(rays, &ray_lanes);
    rt_spread_hits(hits, &hit_lanes);
    uint active = rt_bits(RT_MASK(hits->t >= rt_vfloat(0.0f)));
#ifdef RT_COUNT_STEPS
    const uint count = max(popcount(active), 1u);
    const rt_counts counts_before = *rays->counts;
    const rt_hits before = *hits;
#endif
    for (; active != 0u; active &= active - 1u) {
        const uint l = rt_lowest(active);
        rt_single_ray ray;
        ray.ox = ray_lanes.ox[l], ray.oy = ray_lanes.oy[l], ray.oz = ray_lanes.oz[l];
        ray.dx = ray_lanes.dx[l], ray.dy = ray_lanes.dy[l], ray.dz = ray_lanes.dz[l];
        ray.t_min = ray_lanes.t_min[l];
        ray.ix = ray_lanes.ix[l], ray.iy = ray_lanes.iy[l], ray.iz = ray_lanes.iz[l];
        ray.near_x = ray_lanes.near_x[l], ray.near_y = ray_lanes.near_y[l], ray.near_z = ray_lanes.near_z[l];
        ray.far_x = ray_lanes.far_x[l], ray.far_y = ray_lanes.far_y[l], ray.far_z = ray_lanes.far_z[l];
        ray.packet = rays;
        ray.lanes = &ray_lanes;
        ray.lane = l;
        rt_single_hit hit;
        hit.t = hit_lanes.t[l];
        hit.packet = hits;
        hit.lanes = &hit_lanes;
#ifdef RT_COUNT_STEPS
        ray.counts = rays->counts;
#endif
        rt_clear_counters(&hit);
        RT_CLEAR_OVERFLOW(&hit)
        RT_TRAVERSE(ctx, root, &ray, &hit);
        rt_add_counters(hits, &hit);
        RT_TALLY_OVERFLOW(hits, &hit)
    }
#ifdef RT_COUNT_STEPS
    /* What a packet visits and tests is the mean over its rays: then it compares with packets that stay together. */
    rt_finish_packet_counts(rays->counts, &counts_before, count);
    rt_finish_packet(hits, &before, count);
#endif
    rt_gather_hits(&hit_lanes, hits);
}
