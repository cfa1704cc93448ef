/* wide_unpack.h -- the boxes of a node's children, as kernels read them. You hand in this file and wide_pack.hpp.
 *
 * OpenCL C. page.md says what to do, and what this file may use. child: 0 to 3. axis: 0 to 2, for x, y, z.
 * These give the box of all children for each of them. */

float wide_low(const wide_node *node, uint child, uint axis)
{
    return node->frame[axis];
}

float wide_high(const wide_node *node, uint child, uint axis)
{
    return node->frame[3u + axis];
}
