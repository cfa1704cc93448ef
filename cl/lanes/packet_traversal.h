/* packet_traversal.h -- the traversal loop for a packet of rays: one way through the tree for all lanes, with a stack.
 *
 * A child is visited if any lane's ray enters it (Wald, Slusallek, Benthin, Wagner 2001, "Interactive Rendering with Coherent
 * Ray Tracing"). The stack holds the node reference of each deferred child and each lane's entry distance, so that a child
 * beyond the lanes' nearest hits is skipped without a look at it.
 *
 * A template, see CONTRACT.md. A plugin's traversal includes it as "cl/lanes/packet_traversal.h" and binds
 *   RT_PACKET_STACK_SIZE  the number of stack entries
 *   RT_PACKET_RAYS        the type of what its box tests need of the rays; rt_rays if these are enough
 *   RT_CAT(RT_TRAVERSE, _children)  its box tests, a function that is declared here and defined behind the #include
 * It gets the function RT_CAT(RT_TRAVERSE, _packet).
 *
 * A node reference is the index of a node, in the plugin's own terms; or, with bit 31 set, a leaf: bits 28..30 are the number
 * of its primitives, bits 0..27 the position of the first in leaf order. */
#ifndef RT_PACKET_TRAVERSAL_H
#define RT_PACKET_TRAVERSAL_H

#define RT_REF_IS_LEAF(ref) (((ref) >> 31) != 0u)
#define RT_REF_LEAF_COUNT(ref) (((ref) >> 28) & 7u)
#define RT_REF_LEAF_FIRST(ref) ((ref)&0x0FFFFFFFu)

typedef struct rt_packet_stack {
    vfloat *entry; /* INFINITY in lanes that do not enter the child */
    uint *ref;
    uint top, size;
} rt_packet_stack;

/* Defers a child. */
RT_INLINE void rt_push_packet(rt_packet_stack *stack, uint ref, vfloat entry, rt_hits *hit)
{
    stack->ref[stack->top] = ref;
    stack->entry[stack->top] = entry;
    if (RT_STACK_OK(stack->top + 1u, stack->size, hit)) ++stack->top;
}

#endif

/* Pushes the children of the node `ref` that are entered, the farthest first. */
RT_INLINE void RT_CAT(RT_TRAVERSE, _children)(const rt_ctx *ctx, uint ref, const rt_rays *ray, const RT_PACKET_RAYS *prepared,
                                              rt_hits *hit, rt_packet_stack *stack);

RT_INLINE void RT_CAT(RT_TRAVERSE, _packet)(const rt_ctx *ctx, uint root, const rt_rays *ray, const RT_PACKET_RAYS *prepared,
                                            rt_hits *hit)
{
    vfloat stack_entry[RT_PACKET_STACK_SIZE];
    uint stack_ref[RT_PACKET_STACK_SIZE];
    rt_packet_stack stack;
    stack.entry = stack_entry;
    stack.ref = stack_ref;
    stack.top = 0u;
    stack.size = RT_PACKET_STACK_SIZE;
    uint ref = root, inside = rt_bits(RT_MASK(hit->t >= rt_vfloat(0.0f))); /* lanes in the node, for programs that count */
    for (;;) {
        if (RT_REF_IS_LEAF(ref)) {
            const uint first = RT_REF_LEAF_FIRST(ref), count = RT_REF_LEAF_COUNT(ref);
            for (uint i = 0; i < count; ++i) RT_LEAF(ctx, first + i, ray, hit);
#if RT_ANY_HIT
            if (!rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return;
#endif
        } else {
            RT_HOST_COUNT(ray, nodes, 1u);
            RT_COUNT_VISIT(hit, inside);
            RT_CAT(RT_TRAVERSE, _children)(ctx, ref, ray, prepared, hit, &stack);
        }
        do {
            if (stack.top == 0u) return;
            --stack.top;
            inside = rt_bits(RT_MASK(stack_entry[stack.top] <= hit->t));
        } while (inside == 0u);
        ref = stack_ref[stack.top];
    }
}
