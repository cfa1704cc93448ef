/* curve.cl -- the places of primitives on a Morton curve, behind reduce.cl, whose bounds it takes. */

/* Puts two zeros between the lowest 21 bits. */
RT_INLINE ulong rt_spread(ulong x)
{
    x = (x | x << 32) & 0x001F00000000FFFFul;
    x = (x | x << 16) & 0x001F0000FF0000FFul;
    x = (x | x << 8) & 0x100F00F00F00F00Ful;
    x = (x | x << 4) & 0x10C30C30C30C30C3ul;
    return (x | x << 2) & 0x1249249249249249ul;
}

/* keys[i]: the code of the centre of box i, with axis_bits bits for each axis; values[i]: i. parts: bounds of all boxes together.
 * Cells are cubes, so that a split halves the longest side. */
RT_BUILD_KERNEL curve_codes(const global rt_build_box *boxes, uint count, uint each, uint axis_bits,
                            const global rt_build_bounds *parts, uint part_count, global ulong *keys, global uint *values)
{
    RT_SHARED_BOUNDS
    rt_build_bounds bounds = rt_no_bounds();
    if (part_count == 1u) {
        bounds = parts[0];
    } else {
        for (uint i = RT_ITEM; i < part_count; i += RT_GROUP) rt_add_bounds(&bounds, parts + i);
        RT_ALL_BOUNDS(&bounds);
    }
    float extent = 0.0f;
    for (uint a = 0u; a < 3u; ++a) extent = max(extent, bounds.at[9u + a] - bounds.at[3u + a]);
    const float cells = (float)(1u << axis_bits);
    const float scale = extent > 0.0f ? min(cells / extent, FLT_MAX) : 0.0f;
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, count);
    for (uint i = begin + RT_ITEM; i < end; i += RT_GROUP) {
        ulong code = 0ul;
        for (uint a = 0u; a < 3u; ++a) {
            const float centre = 0.5f * boxes[i].lo[a] + 0.5f * boxes[i].hi[a];
            const float cell = min(max((centre - bounds.at[3u + a]) * scale, 0.0f), cells - 1.0f);
            code |= rt_spread((ulong)cell) << (2u - a);
        }
        keys[i] = code;
        values[i] = i;
    }
}
