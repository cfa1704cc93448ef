/* microfacet.cl -- a metal with rough facets. This is the file that you hand in. Now it is a matt surface, which is right, but no metal.
 *
 * OpenCL C, one ray at a time. page.md says what to do, and what this file may use. Directions are unit vectors away from the surface;
 * z is its normal, wo.z > 0 and wi.z > 0. numbers[0] is `rough`; color is what the metal reflects when it is seen from above. */

/* f, without a cosine. */
RT_INLINE float3 microfacet_eval(const global float *numbers, float3 color, float3 wo, float3 wi) { return 0.31830989f * color; }

/* The density with which microfacet_sample draws wi, 1/sr. */
RT_INLINE float microfacet_pdf(const global float *numbers, float3 color, float3 wo, float3 wi) { return 0.31830989f * wi.z; }

/* Draws a direction. u: three independent numbers in [0, 1). draw.pdf = 0 draws none. */
RT_INLINE rt_surface_draw microfacet_sample(const global float *numbers, float3 color, float3 wo, float3 u)
{
    const float radius = sqrt(u.x), turn = 6.2831853f * u.y;
    rt_surface_draw draw;
    draw.wi = (float3)(radius * cos(turn), radius * sin(turn), sqrt(fmax(1.0f - u.x, 0.0f)));
    draw.pdf = microfacet_pdf(numbers, color, wo, draw.wi);
    draw.weight = color; /* f cos / pdf */
    return draw;
}
