/* packet_stream.h -- how many blocks of rays are traced together.
 *
 * One vector of rays fills the lanes of a ray test. Neighbouring vectors mostly go down the same tree, so a structure may take
 * RT_STREAM of them down together, each a lane again: bounds of a whole vector of rays in one lane, against one box after the
 * other (rt_trace_stream() of query.h, RT_TRAVERSE_STREAM of the plugin). Tracers hold a stream's rays in private arrays; where
 * nothing goes by streams they are of one element, which compilers keep in registers.
 *
 * An instance's tree vectors of rays enter one by one: taking a stream there together was 2 to 10 % slower, for what it takes
 * to tell who enters. While rays are written down one after the other, all go one by one. */
#ifndef RT_PACKET_STREAM_H
#define RT_PACKET_STREAM_H

#if defined(RT_TRAVERSES_STREAMS) && RT_CPU && RT_LANES > 1 && !defined(RT_INSPECT)
#define RT_STREAM RT_LANES
#define RT_STREAM_OF(blocks_left) min(blocks_left, (uint)RT_LANES)
#define RT_FOR_EACH_PACKET(b, count) for (uint b = 0; b < (count); ++b)
#else
#undef RT_SPLITS_INCOHERENT
#define RT_STREAM 1
#define RT_STREAM_OF(blocks_left) 1u
/* `b` is plainly 0, so that no compiler takes an array of one for something to index: an H200 took 5 to 8 % longer for rays from memory. */
#define RT_FOR_EACH_PACKET(b, count) for (uint b = 0, b##_once = 1; b##_once; b##_once = 0)
#endif

/* Blocks from `begin` to `end`, a stream at a time. A GPU's work-item has one, and no loop for it. */
#if RT_MAX_PIXELS == 1 && RT_LANES == 1
#define RT_FOR_STREAMS(base, begin, end) for (uint base = (begin), base##_once = base < (end); base##_once; base##_once = 0)
#else
#define RT_FOR_STREAMS(base, begin, end) for (uint base = (begin); base < (end); base += RT_STREAM)
#endif

/* Lane p: the greatest lane of v[p], of RT_LANES vectors. Two by two they become one, each keeping half as many numbers of its own,
 * until one lane is left: two shuffles and a maximum for every two vectors, a third of what one after the other takes. */
#if RT_STREAM > 1
#if defined(RT_PORTABLE) || !defined(__clang__)
RT_INLINE vfloat rt_greatest_each(const vfloat *v)
{
    float each[RT_LANES];
    for (uint p = 0; p < RT_LANES; ++p) each[p] = rt_greatest(v[p]);
    return rt_load(each);
}
#else
#define RT_SHUFFLE __builtin_shufflevector
#if RT_LANES == 16
#define RT_HALVES(a, b)                                                                                                          \
    rt_max(RT_SHUFFLE(a, b, 0, 1, 2, 3, 4, 5, 6, 7, 16, 17, 18, 19, 20, 21, 22, 23),                                             \
           RT_SHUFFLE(a, b, 8, 9, 10, 11, 12, 13, 14, 15, 24, 25, 26, 27, 28, 29, 30, 31))
#define RT_QUARTERS(a, b)                                                                                                        \
    rt_max(RT_SHUFFLE(a, b, 0, 1, 2, 3, 8, 9, 10, 11, 16, 17, 18, 19, 24, 25, 26, 27),                                           \
           RT_SHUFFLE(a, b, 4, 5, 6, 7, 12, 13, 14, 15, 20, 21, 22, 23, 28, 29, 30, 31))
#define RT_PAIRS(a, b)                                                                                                           \
    rt_max(RT_SHUFFLE(a, b, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29),                                           \
           RT_SHUFFLE(a, b, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31))
#define RT_SINGLES(a, b)                                                                                                         \
    rt_max(RT_SHUFFLE(a, b, 0, 2, 16, 18, 4, 6, 20, 22, 8, 10, 24, 26, 12, 14, 28, 30),                                          \
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
/* By which bit of their numbers vectors meet: 2 at halves, 3 at quarters, 0 and 1 within parts of four lanes. So all end up in order. */
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
