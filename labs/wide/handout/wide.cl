/* wide.cl -- traces rays through a tree of four children a node, the nearest first. Where their boxes are is read by your functions in
 * wide_unpack.h. */
#ifndef WIDE_UNPACKED
#define WIDE_UNPACKED
#include "wide_unpack.h"
#endif

#define RT_PACKET_STACK_SIZE WIDE_STACK
#define RT_PACKET_RAYS rt_rays
#include "cl/lanes/packet_traversal.h"
#undef RT_PACKET_STACK_SIZE
#undef RT_PACKET_RAYS

/* The loop counts the node. */
RT_INLINE void RT_CAT(RT_TRAVERSE, _children)(const rt_ctx *ctx, uint ref, const rt_rays *ray, const rt_rays *prepared, rt_hits *hit,
                                              rt_packet_stack *stack)
{
    const wide_node node = ctx->wide_nodes[ref]; /* a copy, so that nothing beside it is read */
    vfloat entries[4];
    float nearest[4];
    uint refs[4], count = 0u;
    for (uint i = 0; i < 4u && node.child[i] != WIDE_NONE; ++i) {
        vfloat entry;
        const vmask entered =
            rt_enter_bounds(rt_vfloat(wide_low(&node, i, 0u)), rt_vfloat(wide_low(&node, i, 1u)), rt_vfloat(wide_low(&node, i, 2u)),
                            rt_vfloat(wide_high(&node, i, 0u)), rt_vfloat(wide_high(&node, i, 1u)), rt_vfloat(wide_high(&node, i, 2u)),
                            ray, hit, &entry);
        if (!rt_any(entered)) continue;
        const float least = rt_least_of(entered, entry);
        uint place = count++;
        for (; place > 0u && nearest[place - 1u] < least; --place) {
            entries[place] = entries[place - 1u];
            nearest[place] = nearest[place - 1u];
            refs[place] = refs[place - 1u];
        }
        entries[place] = rt_select(entered, entry, rt_vfloat(INFINITY));
        nearest[place] = least;
        refs[place] = node.child[i];
    }
    for (uint i = 0; i < count && stack->top < WIDE_STACK; ++i) rt_push_packet(stack, refs[i], entries[i], hit);
}

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    RT_CAT(RT_TRAVERSE, _packet)(ctx, root, ray, ray, hit);
}
