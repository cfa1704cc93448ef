/* bvh8_stream_stack.h -- the stack of a stream of packets: children that were deferred, which packets enter each, and where. */
#ifndef BVH8_STREAM_STACK_H
#define BVH8_STREAM_STACK_H

/* Nearest hits: two lists of leaves, each of one node's leaves, then a stack of nodes. Any hits: a stack of both.
 *
 * An any-hit traversal takes up to BVH8_QUEUE_SIZE entries off the stack at once, each of which may defer eight more, while the
 * stack has fewer than BVH8_STACK entries, and then one at a time. Eight entries are written before room is looked for.
 * BVH8_STACK is a multiple of 16, so that the sizes of the arrays are no multiples of a page, which would be slow. */
#define BVH8_LEAF_LISTS (2u * BVH8_WIDTH)
#define BVH8_QUEUE_SIZE 4u
#define BVH8_STREAM_STACK (2u * BVH8_STACK + BVH8_QUEUE_SIZE * BVH8_WIDTH)
typedef struct bvh8_stream_stack {
    vfloat entry[BVH8_STREAM_STACK + BVH8_WIDTH]; /* each packet's entry distance */
    uint slot[BVH8_STREAM_STACK + BVH8_WIDTH];    /* node * 8 + slot, from which the child and its box are found again */
    uint packets[BVH8_STREAM_STACK + BVH8_WIDTH]; /* bits of the packets that enter */
} bvh8_stream_stack;

/* The packets that enter entry `i` and have no nearer hit. t_far: each packet's farthest rt_hits.t. */
RT_INLINE uint bvh8_remaining(const bvh8_stream_stack *stack, uint i, vfloat t_far)
{
    return stack->packets[i] & rt_bits(RT_MASK(stack->entry[i] <= t_far));
}

/* Defers the children `slots` of the node `ref`, one or more, from entry `top` on, and prefetches them. The child nearest to
 * packet `guide` comes last, so that it is taken first. Returns the new top. */
RT_INLINE uint bvh8_push_deferred(bvh8_stream_stack *stack, uint top, const global bvh8_node *nodes, const global rt_packed_prim *leaves,
                                  uint ref, uint slots, const vfloat *entry, const uint *packets, uint guide)
{
    const global uint *child = nodes[ref].child;
    const float *distance = (const float *)entry + guide;
#define BVH8_NEXT(candidate)                                                                                                   \
    const uint slot = rt_lowest(slots);                                                                                        \
    slots &= slots - 1u;                                                                                                       \
    bvh8_prefetch(nodes, leaves, child[slot]);                                                                                 \
    const ulong candidate = BVH8_ENTRY(distance[slot * RT_LANES], ref * BVH8_WIDTH + slot);
#define BVH8_DEFER(candidate)                                                                                                  \
    {                                                                                                                          \
        const uint which = (uint)(candidate) % BVH8_WIDTH;                                                                     \
        stack->slot[top] = (uint)(candidate);                                                                                  \
        stack->packets[top] = packets[which];                                                                                  \
        stack->entry[top] = entry[which];                                                                                      \
        ++top;                                                                                                                 \
    }
    BVH8_NEXT(first)
    ulong nearest = first;
    while (slots != 0u) {
        BVH8_NEXT(next)
        const ulong farther = max(next, nearest);
        nearest = min(next, nearest);
        BVH8_DEFER(farther)
    }
    BVH8_DEFER(nearest)
#undef BVH8_DEFER
#undef BVH8_NEXT
    return top;
}

#ifdef RT_COUNT_STEPS
#define BVH8_COUNT_VISITS(rays, hits, packets)                                                                                 \
    for (uint count_in = packets; count_in != 0u; count_in &= count_in - 1u) {                                                 \
        const uint which = rt_lowest(count_in);                                                                                \
        (void)RT_NODE((rays) + which, ref);                                                                                    \
        RT_COUNT_STEP((hits) + which);                                                                                         \
        RT_COUNT_BOXES((hits) + which, BVH8_WIDTH);                                                                            \
    }
#else
#define BVH8_COUNT_VISITS(rays, hits, packets)
#endif

#endif
