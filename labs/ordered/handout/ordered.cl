/* ordered.cl -- traces one ray through a binary tree. Which node comes next is decided by your two functions in ordered_visit.h. */
#ifndef ORDERED_STACK_TYPE
#define ORDERED_STACK_TYPE

/* Nodes that wait, each with the distance at which the ray enters its box. */
typedef struct ordered_stack {
    uint node[ORDERED_STACK];
    float entry[ORDERED_STACK];
    uint top;      /* how many wait */
    uint overflow; /* whether one found no room */
} ordered_stack;

/* Puts a node on the stack. */
RT_INLINE void ordered_push(ordered_stack *stack, uint node, float entry)
{
    if (stack->top >= ORDERED_STACK) {
        stack->overflow = 1u;
        return;
    }
    stack->node[stack->top] = node;
    stack->entry[stack->top] = entry;
    ++stack->top;
}

#include "ordered_visit.h"

#endif

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_single_ray *ray, rt_single_hit *hit)
{
    ordered_stack stack;
    stack.top = stack.overflow = 0u;
    uint at = root;
    for (;;) {
        if (at & ORDERED_LEAF) {
            const uint first = at & 0x0FFFFFFFu, count = (at >> 28) & 7u;
            for (uint i = 0; i < count; ++i) RT_LEAF(ctx, first + i, ray, hit);
            at = ORDERED_NONE;
        } else {
            RT_COUNT_VISIT(hit, 1u);
            const global ordered_node *node = ctx->ordered_nodes + at;
            float left_entry, right_entry;
            const int left = rt_enter_box(node->left_box, ray, hit, &left_entry) != 0;
            const int right = rt_enter_box(node->right_box, ray, hit, &right_entry) != 0;
            at = ordered_visit(&stack, node->left, left, left_entry, node->right, right, right_entry);
        }
        if (at == ORDERED_NONE) at = ordered_next(&stack, hit->t);
        /* RT_STACK_OK counts a full stack in programs with --debug. */
        if (!RT_STACK_OK(stack.top + stack.overflow, ORDERED_STACK, hit)) return;
        if (at == ORDERED_NONE) return;
    }
}
