/* sort.cl -- one pass of a stable radix sort of (key, value) pairs, by one digit of at most 8 bits: count the digits of each
 * tile, scan the counts (scan.cl), then move each pair to its place (Satish, Harris, Garland 2009, "Designing Efficient Sorting
 * Algorithms for Manycore GPUs"). RT_KEY is uint or ulong, RT_SORT_TILE the number of pairs in a tile.
 *
 * counts[digit * tiles + tile]: so the scan over all of them gives the place of a tile's first pair with that digit.
 *
 * With few tiles, launches cost more than the work. Then the counts of pass p are counts[(p * tiles + tile) * RT_DIGITS + digit]:
 * sort_move adds those of all tiles itself, and counts the digits of the next pass while it moves pairs. */
#define RT_DIGITS 256u
#define RT_DIGIT(key) ((uint)((key) >> shift) & mask)

#if RT_GROUP == 1

RT_BUILD_KERNEL sort_count(const global RT_KEY *keys, uint count, uint shift, uint mask, global uint *counts)
{
    const uint tile = RT_GROUP_NUMBER, tiles = (uint)get_num_groups(0);
    const uint begin = tile * RT_SORT_TILE, end = min(begin + RT_SORT_TILE, count);
    uint found[RT_DIGITS];
    for (uint d = 0u; d < RT_DIGITS; ++d) found[d] = 0u;
    for (uint i = begin; i < end; ++i) ++found[RT_DIGIT(keys[i])];
    for (uint d = 0u; d <= mask; ++d) counts[d * tiles + tile] = found[d];
}

RT_BUILD_KERNEL sort_move(const global RT_KEY *keys, const global uint *values, uint count, uint shift, uint mask,
                          const global uint *places, global RT_KEY *to_keys, global uint *to_values)
{
    const uint tile = RT_GROUP_NUMBER, tiles = (uint)get_num_groups(0);
    const uint begin = tile * RT_SORT_TILE, end = min(begin + RT_SORT_TILE, count);
    uint next[RT_DIGITS];
    for (uint d = 0u; d <= mask; ++d) next[d] = places[d * tiles + tile];
    for (uint i = begin; i < end; ++i) {
        const RT_KEY key = keys[i];
        const uint at = next[RT_DIGIT(key)]++;
        to_keys[at] = key;
        to_values[at] = values[i];
    }
}

#else

/* A team is 32 neighbouring work-items. */
#define RT_TEAM RT_WARP
#define RT_TEAMS (RT_GROUP / RT_TEAM)
#define RT_SORT_ROUNDS (RT_SORT_TILE / RT_GROUP)
#define RT_NO_DIGIT 0xFFFFFFFFu

RT_BUILD_KERNEL sort_count(const global RT_KEY *keys, uint count, uint shift, uint mask, global uint *counts)
{
    local uint found[RT_DIGITS];
    const uint tile = RT_GROUP_NUMBER, tiles = (uint)get_num_groups(0), item = RT_ITEM;
    const uint begin = tile * RT_SORT_TILE, end = min(begin + RT_SORT_TILE, count);
    for (uint d = item; d < RT_DIGITS; d += RT_GROUP) found[d] = 0u;
    RT_LOCAL_BARRIER();
    for (uint i = begin + item; i < end; i += RT_GROUP) atomic_inc(&found[RT_DIGIT(keys[i])]);
    RT_LOCAL_BARRIER();
    for (uint d = item; d <= mask; d += RT_GROUP) counts[d * tiles + tile] = found[d];
}

/* The same for few tiles. Clears the counts of the passes after the first. */
RT_BUILD_KERNEL sort_count_few(const global RT_KEY *keys, uint count, uint shift, uint mask, global uint *counts, uint passes)
{
    local uint found[RT_DIGITS];
    const uint tile = RT_GROUP_NUMBER, tiles = (uint)get_num_groups(0), item = RT_ITEM;
    const uint begin = tile * RT_SORT_TILE, end = min(begin + RT_SORT_TILE, count);
    found[item] = 0u;
    RT_LOCAL_BARRIER();
    for (uint i = begin + item; i < end; i += RT_GROUP) atomic_inc(&found[RT_DIGIT(keys[i])]);
    RT_LOCAL_BARRIER();
    for (uint p = 0u; p < passes; ++p) counts[(p * tiles + tile) * RT_DIGITS + item] = p == 0u ? found[item] : 0u;
}

/* few: there are few tiles, and this is pass `pass`; next_mask is 0 in the last one.
 *
 * Pairs are ranked in rounds. In each round a team takes 32 neighbouring pairs. A pair's rank is the number of pairs with its
 * digit that the team had in earlier rounds, plus those of lower work-items in this round. Then the tile is put in order in local
 * memory, so that neighbours are written to neighbouring places. */
RT_BUILD_KERNEL sort_move(const global RT_KEY *keys, const global uint *values, uint count, uint shift, uint mask,
                          global uint *places, global RT_KEY *to_keys, global uint *to_values, uint few, uint pass,
                          uint next_shift, uint next_mask)
{
    local uint of_team[RT_TEAMS * RT_DIGITS]; /* pairs of a digit so far; later, where the team's pairs of it begin in the tile */
    local uint shared[2u * RT_GROUP], to_place[RT_DIGITS], of_tiles[2][4u * RT_GROUP];
    local RT_KEY sorted_keys[RT_SORT_TILE];
    local uint sorted_values[RT_SORT_TILE];
#ifndef RT_WARPS
    local uint same[RT_TEAMS * RT_DIGITS];
#endif
    const uint tile = RT_GROUP_NUMBER, tiles = (uint)get_num_groups(0), item = RT_ITEM;
    const uint begin = tile * RT_SORT_TILE, in_tile = min(RT_SORT_TILE, count - begin);
    const uint team = item / RT_TEAM, lane = item % RT_TEAM, lower = (1u << lane) - 1u;
    for (uint i = item; i < RT_TEAMS * RT_DIGITS; i += RT_GROUP) {
        of_team[i] = 0u;
#ifndef RT_WARPS
        same[i] = 0u;
#endif
    }
    RT_LOCAL_BARRIER();

    RT_KEY key[RT_SORT_ROUNDS];
    uint value[RT_SORT_ROUNDS], rank[RT_SORT_ROUNDS];
    for (uint r = 0u; r < RT_SORT_ROUNDS; ++r) {
        const uint at = (team * RT_SORT_ROUNDS + r) * RT_TEAM + lane;
        key[r] = at < in_tile ? keys[begin + at] : (RT_KEY)0;
        value[r] = at < in_tile ? values[begin + at] : 0u;
    }
    for (uint r = 0u; r < RT_SORT_ROUNDS; ++r) {
        const bool there = (team * RT_SORT_ROUNDS + r) * RT_TEAM + lane < in_tile;
        const uint digit = there ? RT_DIGIT(key[r]) : RT_NO_DIGIT, entry = team * RT_DIGITS + (there ? digit : 0u);
#ifdef RT_WARPS
        const uint bits = rt_match(digit);
#else
        if (there) atomic_or(&same[entry], 1u << lane);
        RT_LOCAL_BARRIER();
        const uint bits = there ? same[entry] : 0u;
#endif
        rank[r] = of_team[entry] + popcount(bits & lower);
        RT_WARP_BARRIER();
        if (there && (bits & lower) == 0u) {
            of_team[entry] += popcount(bits);
#ifndef RT_WARPS
            same[entry] = 0u;
#endif
        }
        RT_WARP_BARRIER();
    }
    RT_LOCAL_BARRIER();

    /* RT_GROUP == RT_DIGITS: one work-item for each digit. */
    uint in_digit = 0u, ignored;
    for (uint t = 0u; t < RT_TEAMS; ++t) in_digit += of_team[t * RT_DIGITS + item];
    uint next = rt_group_scan(shared, in_digit, &ignored);
    uint place = 0u;
    if (few) { /* each quarter of the group adds a quarter of the tiles, four digits a work-item */
        places += pass * tiles * RT_DIGITS;
        uint4 before = (uint4)(0u), all = (uint4)(0u);
        for (uint t = item / 64u; t < tiles; t += RT_GROUP / 64u) {
            const uint4 in_other = vload4(t * (RT_DIGITS / 4u) + item % 64u, places);
            before += t < tile ? in_other : (uint4)(0u);
            all += in_other;
        }
        vstore4(before, item, of_tiles[0]);
        vstore4(all, item, of_tiles[1]);
        RT_LOCAL_BARRIER();
        uint every = 0u;
        for (uint quarter = 0u; quarter < RT_GROUP / 64u; ++quarter) {
            place += of_tiles[0][quarter * RT_DIGITS + item];
            every += of_tiles[1][quarter * RT_DIGITS + item];
        }
        place += rt_group_scan(shared, every, &ignored);
    } else if (item <= mask) {
        place = places[item * tiles + tile];
    }
    to_place[item] = place - next;
    for (uint t = 0u; t < RT_TEAMS; ++t) {
        const uint more = of_team[t * RT_DIGITS + item];
        of_team[t * RT_DIGITS + item] = next;
        next += more;
    }
    RT_LOCAL_BARRIER();

    for (uint r = 0u; r < RT_SORT_ROUNDS; ++r)
        if ((team * RT_SORT_ROUNDS + r) * RT_TEAM + lane < in_tile) {
            const uint at = of_team[team * RT_DIGITS + RT_DIGIT(key[r])] + rank[r];
            sorted_keys[at] = key[r];
            sorted_values[at] = value[r];
        }
    RT_LOCAL_BARRIER();
    for (uint i = item; i < in_tile; i += RT_GROUP) {
        const RT_KEY k = sorted_keys[i];
        const uint at = to_place[RT_DIGIT(k)] + i;
        to_keys[at] = k;
        to_values[at] = sorted_values[i];
        if (few && next_mask)
            atomic_inc(&places[(tiles + at / RT_SORT_TILE) * RT_DIGITS + ((uint)(k >> next_shift) & next_mask)]);
    }
}
#endif
