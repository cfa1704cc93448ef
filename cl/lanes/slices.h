/* slices.h -- the cells of a regular grid that the rays of a packet pass, slice by slice, and none left out. For
 * RT_TRAVERSE_PACKET.
 *
 * Wald, Ize, Kensler, Knoll, Parker 2006, "Ray Tracing Animated Scenes using Coherent Grid Traversal". All rays go mainly along
 * one axis, or are at most twice as fast along another. Along the two others they are between a least and a greatest
 * coordinate, in each slice of cells across that axis. So a packet needs two lines for each of these two axes, and no decision
 * about a ray. The least of lines is concave, so the line through the least coordinates at both ends is nowhere above it;
 * likewise for the greatest. Both are computed for RT_LANES slices at once. Four slices are looked at together first: which
 * blocks of 4 x 4 x 4 cells the rays may be in (macrocells in the paper), and which cells of these have primitives.
 *
 *     rt_slices s;
 *     if (!rt_begin_slices(&s, box, size, counts, ray, hit)) return false;
 *     while (rt_next_slice(&s, filled, hit))
 *         for (int v = s.first_v; v <= s.last_v; ++v)
 *             for (int u = s.first_u; u <= s.last_u; ++u)
 *                 if (rt_slice_has(&s, filled, u, v)) ... the cell rt_slice_cell(&s, u, v), and rt_slice_meets() for its boxes
 *
 * A traversal includes cells.h and cell_parts.h before it.
 *
 * Planes are computed as box + i * size, so see "Slack" in CONTRACT.md for the builder's part. */
#ifndef RT_SLICES_H
#define RT_SLICES_H
#if RT_LANES > 1

/* Rays are too far apart if they pass more cells of a slice together than this times what they pass in all, one by one. A cell
 * costs a packet less than a ray: the ray's next one is known only when this one is done. */
#define RT_SLICE_CELLS 1.5f

#define RT_LANES_LOG (RT_LANES == 16 ? 4 : RT_LANES == 8 ? 3 : 2)

/* One of the two axes across the slices: the line below all rays, and the line above. In cells from the grid's low side: at the
 * place where the first ray enters, and by how much it rises up to the place where the last ray leaves. */
typedef struct rt_slice_axis {
    float low, low_gain, high, high_gain;
    int count;
    /* For boxes in cells: the bits of their first and last parts along this axis, and of those along the slices' axis at which
     * the lines are lowest and highest; and the lines, in units of these bits. */
    int first_bits, last_bits, low_bits, high_bits;
    float low_scale, low_more, low_rise, high_scale, high_more, high_rise;
} rt_slice_axis;

typedef struct rt_slices {
    int slice, first_u, last_u, first_v, last_v; /* the current slice, and the cells that rays may be in */
    uint cell, cell_u, cell_v;                   /* from the number of one cell to that of the next, along each axis */
    uint block, block_u, block_v;                /* likewise of blocks */
    uint bit, bit_u, bit_v;                      /* likewise of the bits of a block's cells, as shifts */
    int last;                                    /* the slice in which the last ray ends */
    int firsts_u[RT_LANES], lasts_u[RT_LANES], firsts_v[RT_LANES], lasts_v[RT_LANES]; /* see rt_look_ahead() */
    int seen;            /* a slice of the last block that was looked at */
    ulong filled, plane; /* the cells with primitives of the blocks there, all in one; those of its first slice */
    int step, count;     /* 1 or -1, or 0 if no ray enters the grid; the number of slices */
    rt_slice_axis u, v;
    float low, size, slack;
    float sign, begin, end, a_span; /* where the first ray enters and the last one leaves, times sign; 1 / their distance */
    vmask active;
    vfloat z, dz, t; /* of the rays along the axis; of the hits when `end` was computed */
} rt_slices;

/* The one of three that belongs to an axis. */
RT_INLINE vfloat rt_component(uint axis, vfloat x, vfloat y, vfloat z) {
    return axis == 0u ? x : axis == 1u ? y : z;
}

/* o, shear: of the rays along this axis; see rt_rays. to_begin, to_end: how far it is to both places along the slices' axis. */
RT_INLINE rt_slice_axis rt_begin_slice_axis(const rt_slices* s, float low, float size, uint count, vfloat o, vfloat shear,
                                            vfloat to_begin, vfloat to_end) {
    const vfloat a = fma(-shear, to_begin, o), b = fma(-shear, to_end, o);
    const float a_unit = 1.0f / size, low_a = rt_least_of(s->active, a), low_b = rt_least_of(s->active, b),
                high_a = rt_greatest_of(s->active, a), high_b = rt_greatest_of(s->active, b);
    rt_slice_axis axis;
    axis.low = (low_a - s->slack - low) * a_unit;
    axis.low_gain = (low_b - low_a) * a_unit;
    axis.high = (high_a + s->slack - low) * a_unit;
    axis.high_gain = (high_b - high_a) * a_unit;
    axis.count = (int)count;
    return axis;
}

/* What rt_slice_meets() compares with. place: of the bits of this axis; at: of those of the slices' axis (cell_parts.h).
 * a_part: the share of the way in a part. */
RT_INLINE void rt_begin_slice_parts(rt_slice_axis* axis, int place, int at, float a_part) {
    const float low = RT_PARTS * axis->low_gain * a_part, high = RT_PARTS * axis->high_gain * a_part;
    const int low_at = low > 0.0f ? at : at + RT_PART_BITS, high_at = high > 0.0f ? at + RT_PART_BITS : at;
    const int first = place, last = place + RT_PART_BITS;
    axis->first_bits = RT_PART_AT(first), axis->last_bits = RT_PART_AT(last);
    axis->low_bits = RT_PART_AT(low_at), axis->high_bits = RT_PART_AT(high_at);
    axis->low_rise = low * rt_power_of_2(last - low_at), axis->high_rise = high * rt_power_of_2(first - high_at);
    axis->low_more = (rt_min(low, 0.0f) - 1.0f) * rt_power_of_2(last),
    axis->high_more = rt_max(high, 0.0f) * rt_power_of_2(first);
    axis->low_scale = RT_PARTS * rt_power_of_2(last), axis->high_scale = RT_PARTS * rt_power_of_2(first);
}

/* How many cells of a slice all rays together pass along this axis, about; and one ray. */
RT_INLINE float rt_slice_width(const rt_slice_axis* axis) {
    return axis->high - axis->low + 0.5f * (axis->high_gain - axis->low_gain);
}
RT_INLINE float rt_slice_slope(const rt_slice_axis* axis, float slices) {
    return fabs(0.5f * (axis->high_gain + axis->low_gain)) / slices;
}

/* The slice at a place along the slices' axis, times sign; one of the grid's. */
RT_INLINE int rt_slice_of(const rt_slices* s, float place) {
    return (int)clamp((s->sign * place - s->low) / s->size, 0.0f, (float)s->count - 1.0f);
}

/* Returns false if it is better to trace these rays one by one: they go along different axes, or they are too far apart.
 * box, size, counts: the grid's box, the size of its cells, and their numbers. */
RT_INLINE bool rt_begin_slices(rt_slices* s, const global float* box, const global float* size, const global uint* counts,
                               const rt_rays* ray, const rt_hits* hit) {
    const uint kx = ray->kx, ky = ray->ky, kz = ray->kz; /* the axis of some ray, if they differ */
    s->z = rt_component(kz, ray->ox, ray->oy, ray->oz);
    s->dz = rt_component(kz, ray->dx, ray->dy, ray->dz);
    vfloat entry, exit;
    s->active = rt_enter_exit(box, ray, hit, &entry, &exit);
    /* Rays that are no numbers hit nothing, but would spoil the least and the greatest of all lanes. */
    s->active &= RT_MASK((ray->px + ray->py + ray->pz + ray->dx + ray->dy + ray->dz) * rt_vfloat(0.0f) == rt_vfloat(0.0f));
    s->t = hit->t;
    s->step = 0;
    const uint active = rt_bits(s->active);
    if (active == 0u) return true;
    const vfloat inverse = rt_component(kz, ray->ix, ray->iy, ray->iz), fast = rt_vfloat(2.0f) * fabs(s->dz);
    const uint backwards = rt_bits(rt_negative(inverse)) & active;
    if (backwards != 0u && backwards != active) return false;
    if (rt_any(s->active & (RT_MASK(fabs(ray->dx) > fast) | RT_MASK(fabs(ray->dy) > fast) | RT_MASK(fabs(ray->dz) > fast))))
        return false;
    const float low = box[kz], high = box[3u + kz];
    s->sign = backwards ? -1.0f : 1.0f;
    if (rt_any(s->active & RT_MASK(fabs(s->dz) < rt_vfloat(1e-18f)))) return false; /* too short for its reciprocal */
    /* What all coordinates here are computed from is at most five times `largest`, because no ray is more than twice as fast
     * along another axis. The tests of primitives may see a ray 40 RT_EPS of it beside its place (rt_position_slack()); the
     * sums here, the planes and the numbers of cells round by 60 more. */
    const float of_box = rt_max(rt_max(rt_max(fabs(box[0]), fabs(box[3])), rt_max(fabs(box[1]), fabs(box[4]))),
                                rt_max(fabs(box[2]), fabs(box[5])));
    const float largest =
        rt_max(of_box, rt_greatest_of(s->active, rt_max(rt_max(fabs(ray->ox), fabs(ray->oy)), fabs(ray->oz))));
    s->slack = fma(largest, 256.0f * RT_EPS, 4.0f * RT_FAR_SLACK);
    const vfloat sign = rt_vfloat(s->sign);
    s->begin = rt_max(rt_least_of(s->active, fma(s->dz, entry, s->z) * sign) - s->slack, s->sign * (backwards ? high : low));
    s->end = rt_min(rt_greatest_of(s->active, fma(s->dz, exit, s->z) * sign) + s->slack, s->sign * (backwards ? low : high));
    const vfloat to_begin = rt_vfloat(s->sign * s->begin) - s->z, to_end = rt_vfloat(s->sign * s->end) - s->z;
    s->u = rt_begin_slice_axis(s, box[kx], size[kx], counts[kx], rt_component(kx, ray->ox, ray->oy, ray->oz),
                               -inverse * rt_component(kx, ray->dx, ray->dy, ray->dz), to_begin, to_end);
    s->v = rt_begin_slice_axis(s, box[ky], size[ky], counts[ky], rt_component(ky, ray->ox, ray->oy, ray->oz),
                               -inverse * rt_component(ky, ray->dx, ray->dy, ray->dz), to_begin, to_end);
    s->low = low;
    s->size = size[kz];
    const float span = rt_max(s->end - s->begin, s->slack), slices = span / s->size + 1.0f;
    const float slope_u = rt_slice_slope(&s->u, slices), slope_v = rt_slice_slope(&s->v, slices);
    if ((rt_slice_width(&s->u) + slope_u + 1.0f) * (rt_slice_width(&s->v) + slope_v + 1.0f) >
        RT_SLICE_CELLS * (float)popcount(active) * (slope_u + slope_v + 1.0f))
        return false;
    s->a_span = 1.0f / span;
    const uint blocks_x = (counts[0] + 3u) / 4u, blocks_y = (counts[1] + 3u) / 4u;
    const uint cell[3] = {1u, counts[0], counts[0] * counts[1]}, block[3] = {1u, blocks_x, blocks_x * blocks_y};
    s->cell = cell[kz], s->cell_u = cell[kx], s->cell_v = cell[ky];
    s->block = block[kz], s->block_u = block[kx], s->block_v = block[ky];
    s->bit = 2u * kz, s->bit_u = 2u * kx, s->bit_v = 2u * ky;
    s->plane = kz == 0u ? 0x1111111111111111ul : kz == 1u ? 0x000F000F000F000Ful : 0xFFFFul;
    s->filled = 0u;
    const float a_part = s->sign * s->size * s->a_span * (1.0f / RT_PARTS);
    rt_begin_slice_parts(&s->u, RT_PARTS_OF(kx), RT_PARTS_OF(kz), a_part);
    rt_begin_slice_parts(&s->v, RT_PARTS_OF(ky), RT_PARTS_OF(kz), a_part);
    s->step = backwards ? -1 : 1;
    s->count = (int)counts[kz];
    s->slice = rt_slice_of(s, s->begin) - s->step;
    s->last = rt_slice_of(s, s->end);
    s->seen = ~(s->slice + s->step);
    return true;
}

/* Of RT_LANES slices: the first and the last cell along one axis that rays may be in. from, to: the shares of the way where a
 * slice begins and ends. If all rays pass beside the grid, the last cell is less than the first. */
RT_INLINE void rt_look_along(const rt_slice_axis* axis, vfloat from, vfloat to, int* first, int* last) {
    const vfloat low_a = rt_vfloat(axis->low_gain) * from, low_b = rt_vfloat(axis->low_gain) * to;
    const vfloat high_a = rt_vfloat(axis->high_gain) * from, high_b = rt_vfloat(axis->high_gain) * to;
    const vfloat low = rt_vfloat(axis->low) + rt_min(low_a, low_b), high = rt_vfloat(axis->high) + rt_max(high_a, high_b);
    const vfloat most = rt_vfloat((float)axis->count);
    rt_store(rt_to_int(rt_min(rt_max(low, rt_vfloat(0.0f)), most)), first);
    rt_store(rt_to_int(rt_min(rt_max(high, rt_vfloat(-1.0f)), most - rt_vfloat(1.0f))), last);
}

/* Finds the cells that rays may be in, for a group of RT_LANES slices: that of the current slice. A group begins at a multiple
 * of RT_LANES. */
RT_INLINE void rt_look_ahead(rt_slices* s) {
    const vfloat slice = rt_to_float(rt_vint(s->slice & ~(RT_LANES - 1)) + rt_lane_index());
    const vfloat a = fma(slice, rt_vfloat(s->size), rt_vfloat(s->low)),
                 b = fma(slice + rt_vfloat(1.0f), rt_vfloat(s->size), rt_vfloat(s->low));
    const vfloat sign = rt_vfloat(s->sign), begin = rt_vfloat(s->begin), a_span = rt_vfloat(s->a_span);
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    const vfloat from = rt_min(rt_max((a * sign - begin) * a_span, zero), one),
                 to = rt_min(rt_max((b * sign - begin) * a_span, zero), one);
    rt_look_along(&s->u, from, to, s->firsts_u, s->lasts_u);
    rt_look_along(&s->v, from, to, s->firsts_v, s->lasts_v);
}

/* The number of the block of a cell of the current slice, and the bit of the cell in it. */
RT_INLINE uint rt_slice_block(const rt_slices* s, int u, int v) {
    return (uint)(s->slice >> 2) * s->block + (uint)(u >> 2) * s->block_u + (uint)(v >> 2) * s->block_v;
}
RT_INLINE uint rt_slice_bit(const rt_slices* s, int u, int v) {
    return ((uint)(s->slice & 3) << s->bit) + ((uint)(u & 3) << s->bit_u) + ((uint)(v & 3) << s->bit_v);
}

/* The cells with primitives of all blocks that rays may be in between the current slice and another one of its block, as one.
 */
RT_INLINE ulong rt_filled_blocks(const rt_slices* s, const global ulong* filled, int last) {
    const int here = s->slice & (RT_LANES - 1), there = last & (RT_LANES - 1);
    const int first_u = min(s->firsts_u[here], s->firsts_u[there]) & ~3, last_u = max(s->lasts_u[here], s->lasts_u[there]);
    const int first_v = min(s->firsts_v[here], s->firsts_v[there]) & ~3, last_v = max(s->lasts_v[here], s->lasts_v[there]);
    ulong any = 0u;
    for (int v = first_v; v <= last_v; v += 4)
        for (int u = first_u; u <= last_u; u += 4) any |= filled[rt_slice_block(s, u, v)];
    return any;
}

/* Goes to the next slice in which rays may be in cells, but for slices of empty cells. filled: of each block, the bits of its
 * cells that have primitives. hit: the rays' nearest hits so far. Returns false if there is none before these. */
RT_INLINE bool rt_next_slice(rt_slices* s, const global ulong* filled, const rt_hits* hit) {
    if (s->step == 0) return false;
    if (rt_any(s->active & RT_MASK(hit->t < s->t))) {
        s->t = hit->t;
        s->active &= RT_MASK(hit->t >= rt_vfloat(0.0f));
        if (!rt_any(s->active)) return false;
        s->end = rt_min(s->end, rt_greatest_of(s->active, fma(s->dz, hit->t, s->z) * rt_vfloat(s->sign)) + s->slack);
        s->last = rt_slice_of(s, s->end);
    }
    while ((s->last - s->slice) * s->step > 0) {
        s->slice += s->step;
        if ((s->slice ^ s->seen) >> 2 != 0) {
            const int last = s->step > 0 ? s->slice | 3 : s->slice & ~3;
            if ((s->slice ^ s->seen) >> RT_LANES_LOG != 0) rt_look_ahead(s);
            s->seen = s->slice;
            s->filled = rt_filled_blocks(s, filled, last);
            if (s->filled == 0u) {
                s->slice = last;
                continue;
            }
        }
        if ((s->filled & s->plane << ((uint)(s->slice & 3) << s->bit)) == 0u) continue;
        const int here = s->slice & (RT_LANES - 1);
        s->first_u = s->firsts_u[here], s->last_u = s->lasts_u[here];
        s->first_v = s->firsts_v[here], s->last_v = s->lasts_v[here];
        if (s->first_u <= s->last_u && s->first_v <= s->last_v) return true;
    }
    return false;
}

/* Whether a cell of the current slice has primitives. */
RT_INLINE bool rt_slice_has(const rt_slices* s, const global ulong* filled, int u, int v) {
    return (filled[rt_slice_block(s, u, v)] >> rt_slice_bit(s, u, v) & 1u) != 0u;
}

RT_INLINE uint rt_slice_cell(const rt_slices* s, int u, int v) {
    return (uint)s->slice * s->cell + (uint)u * s->cell_u + (uint)v * s->cell_v;
}

/* The lanes with boxes in a cell that reach below the upper line along one axis, and above the lower one. parts: of the boxes.
 * share: of the way, where the slice begins on its low side. */
RT_INLINE vmask rt_meets_along(const rt_slice_axis* axis, int cell, vint parts, float share) {
    const float low = fma(fma(axis->low_gain, share, axis->low) - (float)cell, axis->low_scale, axis->low_more),
                high = fma(fma(axis->high_gain, share, axis->high) - (float)cell, axis->high_scale, axis->high_more);
    return RT_MASK(rt_part_numbers(parts, axis->first_bits) <=
                   fma(rt_vfloat(axis->high_rise), rt_part_numbers(parts, axis->high_bits), rt_vfloat(high))) &
           RT_MASK(rt_part_numbers(parts, axis->last_bits) >=
                   fma(rt_vfloat(axis->low_rise), rt_part_numbers(parts, axis->low_bits), rt_vfloat(low)));
}

/* The bits of those of `count` boxes, or of the first RT_LANES, that the rays may meet in a cell of the current slice. */
RT_INLINE uint rt_slice_meets(const rt_slices* s, int u, int v, const global uint* parts, uint count) {
    const vint all = rt_load_parts(parts);
    const float share = (s->sign * fma((float)s->slice, s->size, s->low) - s->begin) * s->a_span;
    return rt_bits(rt_meets_along(&s->u, u, all, share) & rt_meets_along(&s->v, v, all, share)) & rt_first_lanes(count);
}

#endif
#endif
