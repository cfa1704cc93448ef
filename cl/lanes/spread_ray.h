/* spread_ray.h -- one ray and its hit, for traversals with RT_TRAVERSES_SINGLE_RAYS: every branch is free in them.
 *
 * In programs of one lane these are rt_rays and rt_hits. Elsewhere the host takes one lane of a packet after the other, and the
 * names of rays.h mean the same for a ray: they are overloaded. */
#ifndef RT_SPREAD_RAY_H
#define RT_SPREAD_RAY_H

#if RT_LANES == 1

#define rt_single_ray rt_rays
#define rt_single_hit rt_hits

#else

typedef struct rt_single_ray {
    float ox, oy, oz, dx, dy, dz, t_min;
    float ix, iy, iz, near_x, near_y, near_z, far_x, far_y, far_z;
    /* The host's: its packet, as vectors and as arrays. */
    const rt_rays *packet;
    const rt_single_rays *lanes;
    uint lane;
#ifdef RT_COUNT_STEPS
    rt_counts *counts;
#endif
} rt_single_ray;

typedef struct rt_single_hit {
    float t;
    /* The host's. */
    rt_hits *packet;
    rt_single_hits *lanes;
#ifdef RT_COUNT_STEPS
    RT_HIT_COUNTERS(RT_COUNTER_MEMBER)
#endif
#ifdef RT_DEBUG
    uint overflow;
#endif
} rt_single_hit;

#ifdef RT_COUNT_STEPS
RT_INLINE RT_OVERLOADED void rt_clear_counters(rt_single_hit *to) { RT_HIT_COUNTERS(RT_COUNTER_CLEAR) }
RT_INLINE RT_OVERLOADED void rt_add_counters(rt_hits *to, const rt_single_hit *from) { RT_HIT_COUNTERS(RT_COUNTER_ADD) }
/* Makes the counts of a packet of those of its rays, which were traced one by one. before: its own, before them. */
RT_INLINE void rt_finish_packet(rt_hits *to, const rt_hits *before, uint rays) { RT_HIT_COUNTERS(RT_COUNTER_OF_PACKET) }
RT_INLINE void rt_finish_packet_counts(rt_counts *to, const rt_counts *before, uint rays) { RT_HELPER_COUNTERS(RT_COUNTER_OF_PACKET) }
#endif

RT_INLINE RT_OVERLOADED int rt_enter_exit(const global float *box, const rt_single_ray *r, const rt_single_hit *h, float *entry,
                                          float *exit)
{
    RT_HOST_COUNT(r, boxes, 1u);
    const uint x = r->ix < 0.0f ? 3u : 0u, y = r->iy < 0.0f ? 4u : 1u, z = r->iz < 0.0f ? 5u : 2u; /* near planes */
    const float ax = fma(r->ix, box[x], r->near_x), bx = fma(r->ix, box[3u - x], r->far_x);
    const float ay = fma(r->iy, box[y], r->near_y), by = fma(r->iy, box[5u - y], r->far_y);
    const float az = fma(r->iz, box[z], r->near_z), bz = fma(r->iz, box[7u - z], r->far_z);
    *entry = rt_max(rt_max(ax, ay), rt_max(az, r->t_min));
    *exit = rt_min(rt_min(rt_min(bx, by), bz) * RT_WIDE, h->t);
    return *entry <= *exit;
}

RT_INLINE RT_OVERLOADED int rt_enter_box(const global float *box, const rt_single_ray *r, const rt_single_hit *h, float *entry)
{
    float exit;
    return rt_enter_exit(box, r, h, entry, &exit);
}

RT_INLINE RT_OVERLOADED float rt_position_slack(float o, float d, float t)
{
    return fma(fabs(o), 8.0f * RT_EPS, fma(fabs(d * t), 16.0f * RT_EPS, RT_FAR_SLACK));
}

#endif
#endif
