/* span_stack.h -- the nodes that one ray has yet to visit where nodes part space, each with the distances between which the ray is in
 * it. The nearest stands on top. 12 bytes an entry. */
#ifndef RT_SPAN_STACK_H
#define RT_SPAN_STACK_H

typedef struct rt_span {
    uint node;
    float from, to;
} rt_span;

/* Takes the nearest node that the ray enters before its hit at t. Returns false if there is none. */
RT_INLINE bool rt_pop_span(const rt_span *stack, uint *top, float t, rt_span *now)
{
    do {
        if (*top == 0u) return false;
        --*top;
    } while (stack[*top].from > t);
    *now = stack[*top];
    now->to = rt_min(now->to, t);
    return true;
}

#endif
