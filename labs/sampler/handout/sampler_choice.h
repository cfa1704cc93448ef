/* sampler_choice.h -- in which directions light is looked for. This is the file that you hand in. Now it goes by the cosine alone, which
 * is right, and misses most of what the varnish reflects.
 *
 * OpenCL C, one ray at a time. page.md says what to do, and what this file may use. Directions are unit vectors away from the surface;
 * z is its normal, wo.z > 0. numbers: those of the keys `rough` and `varnish`. color: the paint's. */

/* Draws a direction. u: three independent numbers in [0, 1). One with wi.z <= 0 is none. */
RT_INLINE float3 sampler_direction(const global float *numbers, float3 color, float3 wo, float3 u) { return sampler_cosine_draw(u.xy); }

/* The density with which sampler_direction draws wi, 1/sr. wi.z > 0. */
RT_INLINE float sampler_pdf(const global float *numbers, float3 color, float3 wo, float3 wi) { return sampler_cosine_pdf(wi); }
