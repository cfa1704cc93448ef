/* leaf_spread.h -- RT_LEAF of one ray of a packet, for traversals with RT_TRAVERSES_SINGLE_RAYS. RT_PACKET_LEAF is that of the
 * packet. A template, see CONTRACT.md. */
RT_INLINE void RT_LEAF(const rt_ctx *ctx, uint at, const rt_single_ray *ray, rt_single_hit *hit)
{
    rt_single_hits *const lanes = hit->lanes;
#if RT_SINGLE_RAY_MIXED
    if (RT_REF_KIND(ctx->leaves[at].ref) != RT_REF_TRIANGLE) {
        /* Other primitives are tested on lanes. All but this one are inactive meanwhile. */
        const vmask is_this = RT_MASK(rt_lane_index() == rt_vint((int)ray->lane));
        rt_hits *const packet = hit->packet;
        rt_gather_hits(lanes, packet);
        const vfloat others = packet->t;
        packet->t = rt_select(is_this, others, rt_vfloat(-1.0f));
        RT_PACKET_LEAF(ctx, at, ray->packet, packet);
        packet->t = rt_select(is_this, packet->t, others);
        rt_spread_hits(packet, lanes);
    } else
#endif
    {
        RT_HOST_COUNT(ray, tests, 1u);
        RT_FN(rt_hit_triangle_single_ray)(ctx->leaves + at, at, ray->lanes, ray->lane, lanes);
    }
    hit->t = lanes->t[ray->lane];
}
