/* slices.h -- the cells of a regular grid that the rays of a packet pass, slice by slice, and none left out. For RT_TRAVERSE_PACKET.
 *
 * Wald, Ize, Kensler, Knoll, Parker 2006, "Ray Tracing Animated Scenes using Coherent Grid Traversal". All rays go mainly along
 * one axis, or are at most twice as fast along another. Along the two others they are between a least and a greatest coordinate,
 * in each slice of cells across that axis. So a packet needs two lines for each of these two axes, and no decision about a ray.
 * The least of lines is concave, so the line through the least coordinates at both ends is nowhere above it; likewise for the
 * greatest. Four slices are looked at together first: which blocks of 4 x 4 x 4 cells the rays may be in (macrocells in the
 * paper), and whether any of these has a primitive.
 *
 *     rt_slices s;
 *     if (!rt_begin_slices(&s, box, size, counts, ray, hit)) return false;
 *     while (rt_next_slice(&s, filled, hit))
 *         for (int v = s.first_v; v <= s.last_v; ++v)
 *             for (int u = s.first_u; u <= s.last_u; ++u) ... the cell rt_slice_cell(&s, u, v)
 *
 * Planes are computed as box + i * size, so see "Slack" in CONTRACT.md for the builder's part. */
#ifndef RT_SLICES_H
#define RT_SLICES_H
#if RT_LANES > 1

/* Rays are too far apart if they pass more cells of a slice together than this times what they pass in all, one by one. A cell costs a
 * packet less than a ray: the ray's next one is known only when this one is done. */
#define RT_SLICE_CELLS 1.5f

/* One of the two axes across the slices: the line below all rays, and the line above. In cells from the grid's low side: at the
 * place where the first ray enters, and by how much it rises up to the place where the last ray leaves. */
typedef struct rt_slice_axis {
    float low, low_gain, high, high_gain;
    int count;
} rt_slice_axis;

typedef struct rt_slices {
    int slice, first_u, last_u, first_v, last_v; /* the current slice, and the cells that rays may be in */
    uint cell, cell_u, cell_v;                   /* from the number of one cell to that of the next, along each axis */
    uint block, block_u, block_v;                /* likewise of blocks */
    int seen;                                    /* a slice of the last block that was looked at */
    int step, count;                             /* 1 or -1, or 0 if no ray enters the grid; the number of slices */
    rt_slice_axis u, v;
    float low, size, slack;
    float sign, begin, end, a_span; /* where the first ray enters and the last one leaves, times sign; 1 / their distance */
    vmask active;
    vfloat z, dz, t; /* of the rays along the axis; of the hits when `end` was computed */
} rt_slices;

/* The one of three that belongs to an axis. */
RT_INLINE vfloat rt_component(uint axis, vfloat x, vfloat y, vfloat z)
{
    return axis == 0u ? x : axis == 1u ? y : z;
}

/* o, shear: of the rays along this axis; see rt_rays. to_begin, to_end: how far it is to both places along the slices' axis. */
RT_INLINE rt_slice_axis rt_begin_slice_axis(const rt_slices *s, float low, float size, uint count, vfloat o, vfloat shear,
                                            vfloat to_begin, vfloat to_end)
{
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

/* How many cells of a slice all rays together pass along this axis, about; and one ray. */
RT_INLINE float rt_slice_width(const rt_slice_axis *axis)
{
    return axis->high - axis->low + 0.5f * (axis->high_gain - axis->low_gain);
}
RT_INLINE float rt_slice_slope(const rt_slice_axis *axis, float slices)
{
    return fabs(0.5f * (axis->high_gain + axis->low_gain)) / slices;
}

/* Returns false if it is better to trace these rays one by one: they go along different axes, or they are too far apart.
 * box, size, counts: the grid's box, the size of its cells, and their numbers. */
RT_INLINE bool rt_begin_slices(rt_slices *s, const global float *box, const global float *size, const global uint *counts,
                               const rt_rays *ray, const rt_hits *hit)
{
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
    if (rt_any(s->active & (RT_MASK(fabs(ray->dx) > fast) | RT_MASK(fabs(ray->dy) > fast) | RT_MASK(fabs(ray->dz) > fast)))) return false;
    const float low = box[kz], high = box[3u + kz];
    s->sign = backwards ? -1.0f : 1.0f;
    if (rt_any(s->active & RT_MASK(fabs(s->dz) < rt_vfloat(1e-18f)))) return false; /* too short for its reciprocal */
    /* What all coordinates here are computed from is at most five times `largest`, because no ray is more than twice as fast along
     * another axis. The tests of primitives may see a ray 40 RT_EPS of it beside its place (rt_position_slack()); the sums here, the
     * planes and the numbers of cells round by 60 more. */
    const float of_box = rt_max(rt_max(rt_max(fabs(box[0]), fabs(box[3])), rt_max(fabs(box[1]), fabs(box[4]))),
                                rt_max(fabs(box[2]), fabs(box[5])));
    const float largest = rt_max(of_box, rt_greatest_of(s->active, rt_max(rt_max(fabs(ray->ox), fabs(ray->oy)), fabs(ray->oz))));
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
    s->step = backwards ? -1 : 1;
    s->count = (int)counts[kz];
    s->slice = (int)clamp((s->sign * s->begin - low) / s->size, 0.0f, (float)s->count - 1.0f) - s->step;
    s->seen = ~(s->slice + s->step);
    return true;
}

/* Where the rays may be along one axis, in a slice between two shares of the way. Returns false if that is outside of the grid. */
RT_INLINE bool rt_slice_cells(const rt_slice_axis *axis, float from, float to, int *first, int *last)
{
    const float low = axis->low + rt_min(axis->low_gain * from, axis->low_gain * to);
    const float high = axis->high + rt_max(axis->high_gain * from, axis->high_gain * to);
    const float most = (float)axis->count;
    if (!(high >= 0.0f && low < most)) return false;
    *first = (int)rt_max(low, 0.0f);
    *last = (int)rt_min(high, most - 1.0f);
    return true;
}

/* Where rays enter a slice, or leave it, times sign. */
RT_INLINE float rt_slice_side(const rt_slices *s, int slice, int leave)
{
    return s->sign * fma((float)(slice + (s->step > 0 ? leave : 1 - leave)), s->size, s->low);
}

/* Finds the cells that rays may be in from one slice to another, in the order of visits. Returns false if all are outside of the grid. */
RT_INLINE bool rt_find_slice_cells(rt_slices *s, int first, int last)
{
    const float from = clamp((rt_slice_side(s, first, 0) - s->begin) * s->a_span, 0.0f, 1.0f),
                to = clamp((rt_slice_side(s, last, 1) - s->begin) * s->a_span, 0.0f, 1.0f);
    return rt_slice_cells(&s->u, from, to, &s->first_u, &s->last_u) &&
           rt_slice_cells(&s->v, from, to, &s->first_v, &s->last_v);
}

/* Whether a block that has some of these cells has a primitive. */
RT_INLINE bool rt_meets_filled_block(const rt_slices *s, const global uchar *filled)
{
    uint any = 0u;
    for (int v = s->first_v >> 2; v <= s->last_v >> 2; ++v)
        for (int u = s->first_u >> 2; u <= s->last_u >> 2; ++u)
            any |= filled[(uint)(s->slice >> 2) * s->block + (uint)u * s->block_u + (uint)v * s->block_v];
    return any != 0u;
}

/* Goes to the next slice in which rays may be in cells, but for slices of empty blocks. filled: of each block, whether it has a primitive.
 * hit: the rays' nearest hits so far. Returns false if there is none before these. */
RT_INLINE bool rt_next_slice(rt_slices *s, const global uchar *filled, const rt_hits *hit)
{
    if (s->step == 0) return false;
    if (rt_any(s->active & RT_MASK(hit->t < s->t))) {
        s->t = hit->t;
        s->active &= RT_MASK(hit->t >= rt_vfloat(0.0f));
        if (!rt_any(s->active)) return false;
        s->end = rt_min(s->end, rt_greatest_of(s->active, fma(s->dz, hit->t, s->z) * rt_vfloat(s->sign)) + s->slack);
    }
    for (;;) {
        s->slice += s->step;
        if (s->slice < 0 || s->slice >= s->count || !(rt_slice_side(s, s->slice, 0) <= s->end)) return false;
        if ((s->slice ^ s->seen) >> 2 != 0) {
            const int last = s->step > 0 ? s->slice | 3 : s->slice & ~3;
            s->seen = s->slice;
            if (!rt_find_slice_cells(s, s->slice, last) || !rt_meets_filled_block(s, filled)) {
                s->slice = last;
                continue;
            }
        }
        if (rt_find_slice_cells(s, s->slice, s->slice)) return true;
    }
}

RT_INLINE uint rt_slice_cell(const rt_slices *s, int u, int v)
{
    return (uint)s->slice * s->cell + (uint)u * s->cell_u + (uint)v * s->cell_v;
}

#endif
#endif
