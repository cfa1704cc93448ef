/* slices.h -- the cells of a regular grid that the rays of a packet pass, slice by slice, and none left out. For RT_TRAVERSE_PACKET.
 *
 * Wald, Ize, Kensler, Knoll, Parker 2006, "Ray Tracing Animated Scenes using Coherent Grid Traversal". All rays go mainly along
 * one axis. Along the two others they are between a least and a greatest coordinate, in each slice of cells across that axis. So
 * a packet needs two lines for each of these two axes, and no decision about a ray. The least of lines is concave, so the line
 * through the least coordinates at both ends is nowhere above it; likewise for the greatest.
 *
 *     rt_slices s;
 *     if (!rt_begin_slices(&s, box, size, counts, ray, hit)) return false;
 *     while (rt_next_slice(&s, hit))
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
    int step, count;                             /* 1 or -1, or 0 if no ray enters the grid; the number of slices */
    rt_slice_axis u, v;
    float low, size, slack;
    float sign, begin, end, a_span; /* where the first ray enters and the last one leaves, times sign; 1 / their distance */
    vmask active;
    vfloat z, dz, t; /* of the rays along the axis; of the hits when `end` was computed */
} rt_slices;

/* o, shear: of the rays along this axis (rt_rays). to_begin, to_end: how far it is to both places along the slices' axis. */
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

/* Returns false if it is better to trace these rays one by one: they go mainly along different axes, or they are too far apart.
 * box, size, counts: the grid's box, the size of its cells, and their numbers. */
RT_INLINE bool rt_begin_slices(rt_slices *s, const global float *box, const global float *size, const global uint *counts,
                               const rt_rays *ray, const rt_hits *hit)
{
    if (!ray->same_axis) return false;
    vfloat entry, exit;
    s->active = rt_enter_exit(box, ray, hit, &entry, &exit);
    /* Rays that are no numbers hit nothing, but would spoil the least and the greatest of all lanes. */
    s->active &= RT_MASK((ray->px + ray->py + ray->pz + ray->dx + ray->dy + ray->dz) * rt_vfloat(0.0f) == rt_vfloat(0.0f));
    s->t = hit->t;
    s->step = 0;
    const uint active = rt_bits(s->active);
    if (active == 0u) return true;
    const uint backwards = rt_bits(rt_negative(ray->sz)) & active;
    if (backwards != 0u && backwards != active) return false;
    const uint kz = ray->kz;
    const float low = box[kz], high = box[3u + kz];
    s->sign = backwards ? -1.0f : 1.0f;
    s->z = ray->pz;
    s->dz = kz == 0u ? ray->dx : kz == 1u ? ray->dy : ray->dz;
    if (rt_any(s->active & RT_MASK(fabs(s->dz) < rt_vfloat(1e-18f)))) return false; /* too short for its reciprocal */
    /* What all coordinates here are computed from is at most twice `largest`, because no ray is faster along another axis. The
     * tests of primitives may see a ray 40 RT_EPS of it beside its place (rt_position_slack()); the sums here, the planes and
     * the numbers of cells round by 30 more. */
    const float of_box = rt_max(rt_max(rt_max(fabs(box[0]), fabs(box[3])), rt_max(fabs(box[1]), fabs(box[4]))),
                                rt_max(fabs(box[2]), fabs(box[5])));
    const float largest = rt_max(of_box, rt_greatest_of(s->active, rt_max(rt_max(fabs(ray->px), fabs(ray->py)), fabs(ray->pz))));
    s->slack = fma(largest, 128.0f * RT_EPS, 4.0f * RT_FAR_SLACK);
    const vfloat sign = rt_vfloat(s->sign);
    s->begin = rt_max(rt_least_of(s->active, fma(s->dz, entry, s->z) * sign) - s->slack, s->sign * (backwards ? high : low));
    s->end = rt_min(rt_greatest_of(s->active, fma(s->dz, exit, s->z) * sign) + s->slack, s->sign * (backwards ? low : high));
    const vfloat to_begin = rt_vfloat(s->sign * s->begin) - s->z, to_end = rt_vfloat(s->sign * s->end) - s->z;
    s->u = rt_begin_slice_axis(s, box[ray->kx], size[ray->kx], counts[ray->kx], ray->px, ray->sx, to_begin, to_end);
    s->v = rt_begin_slice_axis(s, box[ray->ky], size[ray->ky], counts[ray->ky], ray->py, ray->sy, to_begin, to_end);
    s->low = low;
    s->size = size[kz];
    const float span = rt_max(s->end - s->begin, s->slack), slices = span / s->size + 1.0f;
    const float slope_u = rt_slice_slope(&s->u, slices), slope_v = rt_slice_slope(&s->v, slices);
    if ((rt_slice_width(&s->u) + slope_u + 1.0f) * (rt_slice_width(&s->v) + slope_v + 1.0f) >
        RT_SLICE_CELLS * (float)popcount(active) * (slope_u + slope_v + 1.0f))
        return false;
    s->a_span = 1.0f / span;
    const uint cell[3] = {1u, counts[0], counts[0] * counts[1]};
    s->cell = cell[kz], s->cell_u = cell[ray->kx], s->cell_v = cell[ray->ky];
    s->step = backwards ? -1 : 1;
    s->count = (int)counts[kz];
    s->slice = (int)clamp((s->sign * s->begin - low) / s->size, 0.0f, (float)s->count - 1.0f) - s->step;
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

/* Goes to the next slice in which rays may be in cells. hit: the rays' nearest hits so far. Returns false if there is none before
 * these. */
RT_INLINE bool rt_next_slice(rt_slices *s, const rt_hits *hit)
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
        const int far_side = s->step > 0 ? 1 : 0;
        const float near = s->sign * fma((float)(s->slice + 1 - far_side), s->size, s->low);
        if (!(near <= s->end) || s->slice < 0 || s->slice >= s->count) return false;
        const float far = s->sign * fma((float)(s->slice + far_side), s->size, s->low);
        const float from = clamp((near - s->begin) * s->a_span, 0.0f, 1.0f), to = clamp((far - s->begin) * s->a_span, 0.0f, 1.0f);
        if (rt_slice_cells(&s->u, from, to, &s->first_u, &s->last_u) && rt_slice_cells(&s->v, from, to, &s->first_v, &s->last_v))
            return true;
    }
}

RT_INLINE uint rt_slice_cell(const rt_slices *s, int u, int v)
{
    return (uint)s->slice * s->cell + (uint)u * s->cell_u + (uint)v * s->cell_v;
}

#endif
#endif
