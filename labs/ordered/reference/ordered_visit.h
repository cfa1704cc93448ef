/* ordered_visit.h -- our solution of the lab: the nearer child first, and what begins behind the nearest surface is left out. */

uint ordered_visit(ordered_stack *stack, uint left, int left_entered, float left_entry, uint right, int right_entered,
                   float right_entry)
{
    if (left_entered && right_entered) {
        const int left_first = left_entry <= right_entry;
        ordered_push(stack, left_first ? right : left, left_first ? right_entry : left_entry);
        return left_first ? left : right;
    }
    return left_entered ? left : right_entered ? right : ORDERED_NONE;
}

uint ordered_next(ordered_stack *stack, float nearest)
{
    while (stack->top > 0u) {
        --stack->top;
        if (stack->entry[stack->top] <= nearest) return stack->node[stack->top];
    }
    return ORDERED_NONE;
}
