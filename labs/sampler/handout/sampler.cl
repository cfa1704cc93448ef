/* sampler.cl -- matt paint under a rough varnish. How much light it reflects is settled here; in which directions light is looked for is
 * decided by your two functions in sampler_choice.h.
 *
 * Facets: Walter et al. 2007, Microfacet Models for Refraction through Rough Surfaces; drawn as they are seen: Dupuy, Benyoub 2023,
 * Sampling Visible GGX Normals with Spherical Caps. Paint that gets what the varnish leaves, both ways: Ashikhmin, Shirley 2000, An
 * Anisotropic Phong BRDF Model. */
RT_INLINE float sampler_alpha(const global float *numbers) { return numbers[0] * numbers[0]; }

/* What the varnish reflects, by the cosine to its facets (Schlick). */
RT_INLINE float sampler_fresnel(const global float *numbers, float cosine)
{
    const float low = fmax(1.0f - cosine, 0.0f), square = low * low;
    return numbers[1] + (1.0f - numbers[1]) * (square * square * low);
}

/* D of a facet's normal, and 1 + 2 Lambda. */
RT_INLINE float sampler_facets(float3 h, float alpha)
{
    const float t = (h.x * h.x + h.y * h.y) / (alpha * alpha) + h.z * h.z;
    return 0.31830989f / (alpha * alpha * t * t);
}
RT_INLINE float sampler_smith(float3 w, float alpha) { return sqrt(1.0f + alpha * alpha * (w.x * w.x + w.y * w.y) / (w.z * w.z)); }

/* First way of drawing: by the cosine. u: two numbers. */
RT_INLINE float3 sampler_cosine_draw(float2 u)
{
    const float radius = sqrt(u.x), turn = 6.2831853f * u.y;
    return (float3)(radius * cos(turn), radius * sin(turn), sqrt(fmax(1.0f - u.x, 0.0f)));
}
RT_INLINE float sampler_cosine_pdf(float3 wi) { return 0.31830989f * wi.z; }

/* Second way: the mirror image of wo in a facet of the varnish that is seen from wo. It may be below the surface: then wi.z <= 0. */
RT_INLINE float3 sampler_facet_draw(float alpha, float3 wo, float2 u)
{
    const float3 seen = normalize((float3)(alpha * wo.x, alpha * wo.y, wo.z));
    const float turn = 6.2831853f * u.x, z = (1.0f - u.y) * (1.0f + seen.z) - seen.z, across = sqrt(fmax(1.0f - z * z, 0.0f));
    const float3 facet = (float3)(across * cos(turn), across * sin(turn), z) + seen;
    const float3 h = normalize((float3)(alpha * facet.x, alpha * facet.y, facet.z));
    return normalize(2.0f * dot(wo, h) * h - wo);
}
RT_INLINE float sampler_facet_pdf(float alpha, float3 wo, float3 wi)
{
    return sampler_facets(normalize(wo + wi), alpha) / (2.0f * (1.0f + sampler_smith(wo, alpha)) * wo.z);
}

RT_INLINE float3 sampler_eval(const global float *numbers, float3 color, float3 wo, float3 wi)
{
    const float alpha = sampler_alpha(numbers);
    const float3 h = normalize(wo + wi);
    const float seen = 0.5f / ((sampler_smith(wo, alpha) + sampler_smith(wi, alpha)) * wo.z * wi.z);
    const float varnish = sampler_fresnel(numbers, dot(wo, h)) * sampler_facets(h, alpha) * seen;
    const float paint = 0.31830989f * (1.0f - sampler_fresnel(numbers, wo.z)) * (1.0f - sampler_fresnel(numbers, wi.z));
    return (float3)(varnish) + paint * color;
}

#include "sampler_choice.h"

RT_INLINE rt_surface_draw sampler_sample(const global float *numbers, float3 color, float3 wo, float3 u)
{
    rt_surface_draw draw;
    draw.wi = sampler_direction(numbers, color, wo, u);
    draw.weight = (float3)(0.0f);
    draw.pdf = draw.wi.z > 0.0f ? sampler_pdf(numbers, color, wo, draw.wi) : 0.0f;
    if (draw.pdf > 0.0f) draw.weight = sampler_eval(numbers, color, wo, draw.wi) * (draw.wi.z / draw.pdf);
    return draw;
}
