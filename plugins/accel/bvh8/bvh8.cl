/* bvh8.cl -- chooses the traversal of a tree of eight children a node by what the rays have in common.
 *
 *   bvh8_single_ray.cl       programs of one lane
 *   bvh8_interval_packet.cl  a packet with directions of one octant: the interval of its rays against eight children at once
 *   bvh8_interval_stream.cl  several such packets: their intervals, one in each lane, against one child after the other
 *   bvh8_incoherent.cl       an incoherent packet: its rays have little in common
 *
 * A packet with rays of two octants is traced twice, each time with the rays of one. 224 bytes a node. Made for CPUs. Good for
 * coherent rays, because a node is fetched for many at once; incoherent rays gain from it in trees that outgrow the caches. */
#if RT_LANES == 1

#include "bvh8_single_ray.cl"

#else

#define BVH8_INTERVAL_PACKET RT_CAT(RT_TRAVERSE, _interval_packet)
#define BVH8_INTERVAL_STREAM RT_CAT(RT_TRAVERSE, _interval_stream)
#define BVH8_INTERLEAVED RT_CAT(RT_TRAVERSE, _interleaved)
#define BVH8_INCOHERENT_PACKET RT_CAT(RT_TRAVERSE, _incoherent_packet)
#include "bvh8_interval_packet.cl"
#include "bvh8_incoherent.cl"

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    const vint octants = bvh8_octants(ray);
    const vfloat t = hit->t;
    uint rest = bvh8_octant_bits(ray, octants, t);
    if (popcount(rest) > BVH8_MAX_OCTANTS) {
        BVH8_INCOHERENT_PACKET(ctx, root, ray, hit);
        return;
    }
    for (; rest != 0u; rest &= rest - 1u) {
        const uint octant = rt_lowest(rest);
        const vmask is_of_octant = RT_MASK(octants == rt_vint((int)octant));
        const vfloat others_t = hit->t;
        hit->t = rt_select(is_of_octant, hit->t, rt_vfloat(-1.0f));
        BVH8_INTERVAL_PACKET(ctx, root, octant, ray, hit);
        hit->t = rt_select(is_of_octant, hit->t, others_t);
    }
}

#if RT_STREAM > 1
#include "bvh8_interval_stream.cl"

void RT_TRAVERSE_STREAM(const rt_ctx *ctx, uint root, const rt_rays *rays, rt_hits *hits, uint count)
{
    /* Bits of packets: those that have rays of each octant; incoherent ones; those that have rays of two octants. */
    uint of_octant[8] = {0, 0, 0, 0, 0, 0, 0, 0}, incoherent = 0, of_two = 0;
    for (uint p = 0; p < count; ++p) {
        uint octants = bvh8_octant_bits(rays + p, bvh8_octants(rays + p), hits[p].t);
        if (popcount(octants) > BVH8_MAX_OCTANTS || BVH8_INCOHERENT(rays + p, octants)) {
            incoherent |= 1u << p;
            continue;
        }
        of_two |= (popcount(octants) > 1u ? 1u : 0u) << p;
        for (; octants != 0u; octants &= octants - 1u) of_octant[rt_lowest(octants)] |= 1u << p;
    }
    for (; incoherent != 0u; incoherent &= incoherent - 1u)
        BVH8_INCOHERENT_PACKET(ctx, root, rays + rt_lowest(incoherent), hits + rt_lowest(incoherent));
    for (uint octant = 0; octant < 8u; ++octant) {
        const uint members = of_octant[octant];
        if (members == 0u) continue;
        vfloat others_t[RT_STREAM];
        for (uint split = members & of_two; split != 0u; split &= split - 1u) {
            const uint p = rt_lowest(split);
            others_t[p] = hits[p].t;
            hits[p].t = rt_select(RT_MASK(bvh8_octants(rays + p) == rt_vint((int)octant)), hits[p].t, rt_vfloat(-1.0f));
        }
        if (popcount(members) > 1u)
            BVH8_INTERVAL_STREAM(ctx, root, octant, rays, hits, members);
        else
            BVH8_INTERVAL_PACKET(ctx, root, octant, rays + rt_lowest(members), hits + rt_lowest(members));
        for (uint split = members & of_two; split != 0u; split &= split - 1u) {
            const uint p = rt_lowest(split);
            hits[p].t = rt_select(RT_MASK(bvh8_octants(rays + p) == rt_vint((int)octant)), hits[p].t, others_t[p]);
        }
    }
}
#endif

#undef BVH8_INTERVAL_PACKET
#undef BVH8_INTERVAL_STREAM
#undef BVH8_INTERLEAVED
#undef BVH8_INCOHERENT_PACKET
#endif
