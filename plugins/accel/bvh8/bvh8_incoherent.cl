/* bvh8_incoherent.cl -- one incoherent packet: its rays have little in common.
 *
 * If BVH8_SINGLE is set, because the tree is larger than the caches, each ray is traced by itself (bvh8_interleaved.cl): rays
 * that share few nodes would fetch more nodes if they were traced together. Otherwise all rays are tested together against one
 * box after the other (cl/lanes/packet_traversal.h). The world of a scene with instances is always traced in the second way: a
 * single ray would hold up the others while it is in a mesh. */
#if BVH8_SINGLE && !(RT_SINGLE_RAY_MIXED && RT_HAS_INSTANCES)

#include "bvh8_interleaved.cl"

RT_INLINE void BVH8_INCOHERENT_PACKET(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    bvh8_ray_stacks stacks;
    bvh8_begin_ray_stacks(&stacks, ray, hit);
    BVH8_INTERLEAVED(ctx, &stacks, root, rt_bits(RT_MASK(hit->t >= rt_vfloat(0.0f))), ray, hit);
}

#else

#define RT_PACKET_STACK_SIZE BVH8_STACK
#define RT_PACKET_RAYS bvh8_mixed_rays
#include "cl/lanes/packet_traversal.h"

/* Pushes the children that are entered, by their slots. A ray meets one of a slab's two planes first and then the other,
 * whichever it is: taking the lesser and the greater distance costs less than selecting planes by the signs of each lane's
 * direction. */
RT_INLINE void RT_CAT(RT_TRAVERSE, _children)(const rt_ctx *ctx, uint ref, const rt_rays *ray, const bvh8_mixed_rays *r, rt_hits *hit,
                                              rt_packet_stack *stack)
{
    const global bvh8_node *node = ctx->bvh8_nodes + ref;
    vfloat entry[BVH8_WIDTH];
    uint entered = 0;
    RT_COUNT_BOXES(hit, BVH8_WIDTH);
    __attribute__((opencl_unroll_hint(BVH8_WIDTH)))
    for (uint i = 0; i < BVH8_WIDTH; ++i) {
        const uint slot = i ^ r->far_first;
#define BVH8_MEET(x, axis)                                                                                                     \
    const vfloat lo_##x = fma(r->lo_slope_##x, rt_vfloat(node->plane[axis][slot]), r->lo_offset_##x),                          \
                 hi_##x = fma(r->hi_slope_##x, rt_vfloat(node->plane[axis + 3][slot]), r->hi_offset_##x);
        BVH8_MEET(x, 0)
        BVH8_MEET(y, 1)
        BVH8_MEET(z, 2)
#undef BVH8_MEET
        entry[i] = rt_max(rt_max(rt_min(lo_x, hi_x), rt_min(lo_y, hi_y)), rt_max(rt_min(lo_z, hi_z), ray->t_min));
        const vfloat exit = rt_min(rt_min(rt_max(lo_x, hi_x), rt_max(lo_y, hi_y)), rt_min(rt_max(lo_z, hi_z), hit->t));
        const vmask in = RT_MASK(entry[i] <= exit);
        entry[i] = rt_select(in, entry[i], RT_INFINITY);
        entered |= (rt_any(in) ? 1u : 0u) << i;
    }
    for (; entered != 0u; entered &= entered - 1u) {
        const uint i = rt_lowest(entered), child = node->child[i ^ r->far_first];
        bvh8_prefetch(ctx->bvh8_nodes, ctx->leaves, child);
        rt_push_packet(stack, child, entry[i], hit);
    }
}
#undef RT_PACKET_STACK_SIZE
#undef RT_PACKET_RAYS

RT_INLINE void BVH8_INCOHERENT_PACKET(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    const bvh8_mixed_rays mixed = bvh8_mix_rays(ray);
    RT_CAT(RT_TRAVERSE, _packet)(ctx, root, ray, &mixed, hit);
}

#endif
