/* scan.cl -- the exclusive prefix sum of numbers, in passes: sums of tiles, the scan of these sums, then the tiles themselves
 * (Sengupta, Harris, Zhang, Owens 2007, "Scan Primitives for GPU Computing", in the order reduce, then scan).
 *
 * A tile has RT_SCAN_TILE numbers. A work-group takes `tiles_each` neighbouring tiles. */

#if RT_GROUP > 1
/* A work-item's part of a tile: RT_SCAN_ROUNDS x 4 numbers. Neighbours in a group read neighbours in memory. */
#define RT_SCAN_ROUNDS 4u
RT_INLINE uint4 rt_scan_load(const global uint *data, uint at, uint count)
{
    if (at + 4u <= count) return vload4(0, data + at);
    return (uint4)(at < count ? data[at] : 0u, at + 1u < count ? data[at + 1u] : 0u, at + 2u < count ? data[at + 2u] : 0u, 0u);
}
RT_INLINE uint rt_scan_sum(uint4 v) { return v.x + v.y + v.z + v.w; }
#endif

/* sums[g]: the sum of the numbers that group g has. */
RT_BUILD_KERNEL scan_sums(const global uint *data, uint count, uint tiles_each, global uint *sums)
{
    const uint begin = RT_GROUP_NUMBER * tiles_each * RT_SCAN_TILE, end = min(begin + tiles_each * RT_SCAN_TILE, count);
    uint sum = 0u;
#if RT_GROUP == 1
    for (uint i = begin; i < end; ++i) sum += data[i];
    sums[RT_GROUP_NUMBER] = sum;
#else
    local uint shared[2u * RT_GROUP];
    for (uint at = begin + 4u * RT_ITEM; at < end; at += 4u * RT_GROUP) sum += rt_scan_sum(rt_scan_load(data, at, end));
    uint total;
    rt_group_scan(shared, sum, &total);
    if (RT_ITEM == 0u) sums[RT_GROUP_NUMBER] = total;
#endif
}

/* Replaces each number by the sum of those before it in the group's tiles, plus offsets[g] if has_offsets. */
RT_BUILD_KERNEL scan_tiles(global uint *data, uint count, uint tiles_each, const global uint *offsets, uint has_offsets)
{
    const uint begin = RT_GROUP_NUMBER * tiles_each * RT_SCAN_TILE, end = min(begin + tiles_each * RT_SCAN_TILE, count);
    uint before = has_offsets ? offsets[RT_GROUP_NUMBER] : 0u;
#if RT_GROUP == 1
    for (uint i = begin; i < end; ++i) {
        const uint value = data[i];
        data[i] = before;
        before += value;
    }
#else
    local uint4 shared[2u * RT_GROUP];
    for (uint tile = begin; tile < end; tile += RT_SCAN_TILE) {
        uint4 value[RT_SCAN_ROUNDS], total;
        uint sum[RT_SCAN_ROUNDS];
        for (uint r = 0u; r < RT_SCAN_ROUNDS; ++r) {
            value[r] = rt_scan_load(data, tile + 4u * (r * RT_GROUP + RT_ITEM), end);
            sum[r] = rt_scan_sum(value[r]);
        }
        const uint4 upto = rt_group_scan4(shared, (uint4)(sum[0], sum[1], sum[2], sum[3]), &total);
        const uint first[RT_SCAN_ROUNDS] = {before + upto.x, before + total.x + upto.y, before + total.x + total.y + upto.z,
                                            before + total.x + total.y + total.z + upto.w};
        for (uint r = 0u; r < RT_SCAN_ROUNDS; ++r) {
            const uint at = tile + 4u * (r * RT_GROUP + RT_ITEM), x = value[r].x, y = x + value[r].y, z = y + value[r].z;
            const uint4 result = first[r] + (uint4)(0u, x, y, z);
            if (at + 4u <= end) {
                vstore4(result, 0, data + at);
            } else {
                if (at < end) data[at] = result.x;
                if (at + 1u < end) data[at + 1u] = result.y;
                if (at + 2u < end) data[at + 2u] = result.z;
            }
        }
        before += rt_scan_sum(total);
    }
#endif
}
