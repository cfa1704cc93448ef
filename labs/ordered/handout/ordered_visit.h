/* ordered_visit.h -- which node of the tree comes next. This is the file that you hand in.
 *
 * OpenCL C, one box or node at a time. page.md says what to do, and what this file may use. */

/* Called at an inner node. left, right: its children. left_entered: whether the box of `left` is met, and left_entry: at which distance.
 * Returns the child that is visited now, or ORDERED_NONE if none is. The other one, if its box is met, must not be lost:
 * ordered_push(stack, node, entry) keeps it. */
uint ordered_visit(ordered_stack *stack, uint left, int left_entered, float left_entry, uint right, int right_entered,
                   float right_entry)
{
    return ORDERED_NONE;
}

/* Called where no child is visited now. nearest: the distance of the nearest surface so far; what begins behind it is of no use.
 * Returns a node that waits on the stack, and takes it from there; ORDERED_NONE if none is left. */
uint ordered_next(ordered_stack *stack, float nearest)
{
    return ORDERED_NONE;
}
