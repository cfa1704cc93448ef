/* packet_stream.h -- streams: how many packets of rays are traced together.
 *
 * A packet is RT_LANES rays, one in each lane. Neighbouring packets mostly visit the same nodes, so a structure may trace a
 * stream of RT_STREAM packets together: then a lane holds the bounds of a whole packet (rt_trace_stream() of query.h,
 * RT_TRAVERSE_STREAM of the plugin). Tracers keep the rays of a stream in private arrays. Without streams these have one
 * element, which compilers keep in registers.
 *
 * Packets enter an instance's tree one by one. Tracing a stream there together was 2 to 10 % slower, because deciding which
 * packets enter the instance costs more than it saves.
 * The inspector, which records ray after ray, and lists of all hits have no streams either. */
#ifndef RT_PACKET_STREAM_H
#define RT_PACKET_STREAM_H

#if defined(RT_TRAVERSES_STREAMS) && RT_CPU && RT_LANES > 1 && !defined(RT_INSPECT) && !defined(RT_ALL_HITS)
#define RT_STREAM RT_LANES
#define RT_STREAM_OF(blocks_left) min(blocks_left, (uint)RT_LANES)
#define RT_FOR_EACH_PACKET(b, count) for (uint b = 0; b < (count); ++b)
#else
#undef RT_SPLITS_INCOHERENT
#define RT_STREAM 1
#define RT_STREAM_OF(blocks_left) 1u
/* `b` is a plain 0, so that no compiler indexes an array of one element: on an H200 that made rays from memory 5 to 8 %
 * slower. */
#define RT_FOR_EACH_PACKET(b, count) for (uint b = 0, b##_once = 1; b##_once; b##_once = 0)
#endif

/* A loop over the blocks [begin, end), a stream at a time. A GPU's work-item has one block and no loop. */
#if RT_MAX_PIXELS == 1 && RT_LANES == 1
#define RT_FOR_STREAMS(base, begin, end) for (uint base = (begin), base##_once = base < (end); base##_once; base##_once = 0)
#else
#define RT_FOR_STREAMS(base, begin, end) for (uint base = (begin); base < (end); base += RT_STREAM)
#endif

/* Lane p of the result is the greatest lane of v[p], for RT_LANES vectors. Each step merges vectors in pairs: half of the lanes
 * of the result belong to either. Two shuffles and a maximum for a pair take a third of what vector after vector takes. */
#if RT_STREAM > 1
#if defined(RT_PORTABLE) || !RT_HAS_BUILTIN(__builtin_shufflevector)
RT_INLINE vfloat rt_greatest_each(const vfloat *v)
{
    float each[RT_LANES];
    for (uint p = 0; p < RT_LANES; ++p) each[p] = rt_greatest(v[p]);
    return rt_load(each);
}
#else
#define RT_SHUFFLE __builtin_shufflevector
#if RT_LANES == 16
#define RT_HALVES(a, b)                                                                                                        \
    rt_max(RT_SHUFFLE(a, b, 0, 1, 2, 3, 4, 5, 6, 7, 16, 17, 18, 19, 20, 21, 22, 23),                                           \
           RT_SHUFFLE(a, b, 8, 9, 10, 11, 12, 13, 14, 15, 24, 25, 26, 27, 28, 29, 30, 31))
#define RT_QUARTERS(a, b)                                                                                                      \
    rt_max(RT_SHUFFLE(a, b, 0, 1, 2, 3, 8, 9, 10, 11, 16, 17, 18, 19, 24, 25, 26, 27),                                         \
           RT_SHUFFLE(a, b, 4, 5, 6, 7, 12, 13, 14, 15, 20, 21, 22, 23, 28, 29, 30, 31))
#define RT_PAIRS(a, b)                                                                                                         \
    rt_max(RT_SHUFFLE(a, b, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29),                                         \
           RT_SHUFFLE(a, b, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31))
#define RT_SINGLES(a, b)                                                                                                       \
    rt_max(RT_SHUFFLE(a, b, 0, 2, 16, 18, 4, 6, 20, 22, 8, 10, 24, 26, 12, 14, 28, 30),                                        \
           RT_SHUFFLE(a, b, 1, 3, 17, 19, 5, 7, 21, 23, 9, 11, 25, 27, 13, 15, 29, 31))
#define RT_FOUR(p) RT_QUARTERS(RT_HALVES(v[p], v[(p) + 4]), RT_HALVES(v[(p) + 8], v[(p) + 12]))
#elif RT_LANES == 8
#define RT_FOUR(p) rt_max(RT_SHUFFLE(v[p], v[(p) + 4], 0, 1, 2, 3, 8, 9, 10, 11), RT_SHUFFLE(v[p], v[(p) + 4], 4, 5, 6, 7, 12, 13, 14, 15))
#define RT_PAIRS(a, b) rt_max(RT_SHUFFLE(a, b, 0, 1, 8, 9, 4, 5, 12, 13), RT_SHUFFLE(a, b, 2, 3, 10, 11, 6, 7, 14, 15))
#define RT_SINGLES(a, b) rt_max(RT_SHUFFLE(a, b, 0, 2, 8, 10, 4, 6, 12, 14), RT_SHUFFLE(a, b, 1, 3, 9, 11, 5, 7, 13, 15))
#else
#define RT_FOUR(p) v[p]
#define RT_PAIRS(a, b) rt_max(RT_SHUFFLE(a, b, 0, 1, 4, 5), RT_SHUFFLE(a, b, 2, 3, 6, 7))
#define RT_SINGLES(a, b) rt_max(RT_SHUFFLE(a, b, 0, 2, 4, 6), RT_SHUFFLE(a, b, 1, 3, 5, 7))
#endif
/* The vectors of a pair differ in one bit of their index: bit 2 at halves, bit 3 at quarters, bits 0 and 1 within quarters.
 * That puts all results in order. */
RT_INLINE vfloat rt_greatest_each(const vfloat *v)
{
    return RT_SINGLES(RT_PAIRS(RT_FOUR(0), RT_FOUR(1)), RT_PAIRS(RT_FOUR(2), RT_FOUR(3)));
}
#undef RT_SHUFFLE
#undef RT_HALVES
#undef RT_QUARTERS
#undef RT_FOUR
#undef RT_PAIRS
#undef RT_SINGLES
#endif
#endif

#endif
