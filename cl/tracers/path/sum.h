/* sum.h -- adds a path's light to its pixel, sample after sample in their order, so that pictures are the same bit by bit
 * whatever is traced beside them.
 *
 * The film of `path` has two planes:
 *   SUM   sums of r, g and b, and the number of samples
 *   REST  what these sums lack by rounding (Knuth 1969, The Art of Computer Programming 2, section 4.2.2), and the sum of squared
 *   deviations of the samples' luminance from its mean (Welford 1962, Note on a Method for Calculating Corrected Sums of Squares)
 * The sign of that last sum, if it is a number, says that the pixel rests: the host sets it (host/picture/film_noise.hpp), and no
 * sample is added. */
#ifndef RT_PATH_SUM_H
#define RT_PATH_SUM_H

/* Rec. 709 */
#define RT_LUMINANCE(c) (0.2126f * (c).x + 0.7152f * (c).y + 0.0722f * (c).z)

RT_INLINE void rt_add_sample(global float4 *film, size_t pixels, size_t at, float4 light, bool is_first)
{
    const float4 none = (float4)(0.0f), sum = is_first ? none : film[at], rest = is_first ? none : film[RT_PLANE_REST * pixels + at];
    light.w = 1.0f;
    const float4 rough = sum + light, added = rough - sum, lost = (sum - (rough - added)) + (light - added) + rest;
    const float4 total = rough + lost;
    float4 left = lost - (total - rough);
    const float value = RT_LUMINANCE(light), before = RT_LUMINANCE(sum) / max(sum.w, 1.0f);
    const float count = rough.w, after = RT_LUMINANCE(total) / count;
    /* The mean lies between before and the value; rounding may put it beyond. */
    left.w = is_first ? 0.0f : rest.w + max((value - before) * (value - after), 0.0f);
    film[at] = (float4)(total.xyz, count);
    film[RT_PLANE_REST * pixels + at] = left;
}

#endif
