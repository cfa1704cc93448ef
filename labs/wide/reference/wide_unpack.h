/* wide_unpack.h -- our solution of the lab. The product is exact, because a step is a power of two: so the sum is rounded as the
 * builder rounds it, also where a compiler makes one operation of both. */

float wide_low(const wide_node *node, uint child, uint axis)
{
    return node->frame[axis] + node->frame[3u + axis] * (float)node->lo[child][axis];
}

float wide_high(const wide_node *node, uint child, uint axis)
{
    return node->frame[axis] + node->frame[3u + axis] * (float)node->hi[child][axis];
}
