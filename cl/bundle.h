/* bundle.h -- how many blocks of rays are traced together.
 *
 * One vector of rays fills the lanes of a ray test. Neighbouring vectors mostly go down the same tree, so a structure may take
 * RT_BUNDLE of them down together, each a lane again: bounds of a whole vector of rays in one lane, against one box after the
 * other (rt_trace_bundle() of query.h, RT_TRAVERSE_BUNDLE of the plugin). Tracers hold a bundle's rays in private arrays; where
 * nothing goes by bundles they are of one element, which compilers keep in registers.
 *
 * An instance's tree vectors of rays enter one by one: taking a bundle there together was 2 to 10 % slower, for what it takes
 * to tell who enters. While rays are written down one after the other, all go one by one. */
#ifndef RT_BUNDLE_H
#define RT_BUNDLE_H

#if defined(RT_TRAVERSES_BUNDLES) && RT_CPU && RT_LANES > 1 && !defined(RT_INSPECT)
#define RT_BUNDLE RT_LANES
#define RT_BUNDLE_OF(blocks_left) min(blocks_left, (uint)RT_LANES)
#define RT_FOR_EACH(b, count) for (uint b = 0; b < (count); ++b)
#else
#undef RT_PARTS_SCATTERED
#define RT_BUNDLE 1
#define RT_BUNDLE_OF(blocks_left) 1u
/* `b` is plainly 0, so that no compiler takes an array of one for something to index: an H200 took 5 to 8 % longer for rays from memory. */
#define RT_FOR_EACH(b, count) for (uint b = 0, b##_once = 1; b##_once; b##_once = 0)
#endif

/* Blocks from `begin` to `end`, a bundle at a time. A GPU's work-item has one, and no loop for it. */
#if RT_MAX_PIXELS == 1 && RT_LANES == 1
#define RT_FOR_BUNDLES(base, begin, end) for (uint base = (begin), base##_once = base < (end); base##_once; base##_once = 0)
#else
#define RT_FOR_BUNDLES(base, begin, end) for (uint base = (begin); base < (end); base += RT_BUNDLE)
#endif

#endif
