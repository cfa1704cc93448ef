/* microfacet.cl -- our solution of the lab: GGX facets that shadow and mask each other at the heights where they are, drawn as they are
 * seen from wo.
 *
 * Walter et al. 2007, Microfacet Models for Refraction through Rough Surfaces; Heitz 2014, Understanding the Masking-Shadowing Function;
 * Dupuy, Benyoub 2023, Sampling Visible GGX Normals with Spherical Caps. */

RT_INLINE float microfacet_alpha(const global float *numbers) { return numbers[0] * numbers[0]; }

/* D of a facet's normal. By slopes: of 1 - z^2 few digits are left where z is nearly 1. */
RT_INLINE float microfacet_facets(float3 h, float alpha)
{
    const float t = (h.x * h.x + h.y * h.y) / (alpha * alpha) + h.z * h.z;
    return 0.31830989f / (alpha * alpha * t * t);
}

/* 1 + 2 Lambda. */
RT_INLINE float microfacet_smith(float3 w, float alpha) { return sqrt(1.0f + alpha * alpha * (w.x * w.x + w.y * w.y) / (w.z * w.z)); }

RT_INLINE float3 microfacet_fresnel(float3 color, float cosine)
{
    const float low = fmax(1.0f - cosine, 0.0f), square = low * low;
    return color + (1.0f - color) * (square * square * low);
}

RT_INLINE float3 microfacet_eval(const global float *numbers, float3 color, float3 wo, float3 wi)
{
    const float alpha = microfacet_alpha(numbers);
    const float3 h = normalize(wo + wi);
    /* G / (4 cos cos), in which G = 2 / (smith + smith'). */
    const float seen = 0.5f / ((microfacet_smith(wo, alpha) + microfacet_smith(wi, alpha)) * wo.z * wi.z);
    return microfacet_fresnel(color, dot(wo, h)) * (microfacet_facets(h, alpha) * seen);
}

RT_INLINE float microfacet_pdf(const global float *numbers, float3 color, float3 wo, float3 wi)
{
    const float alpha = microfacet_alpha(numbers);
    return microfacet_facets(normalize(wo + wi), alpha) / (2.0f * (1.0f + microfacet_smith(wo, alpha)) * wo.z);
}

RT_INLINE rt_surface_draw microfacet_sample(const global float *numbers, float3 color, float3 wo, float3 u)
{
    const float alpha = microfacet_alpha(numbers), turn = 6.2831853f * u.x;
    /* In a space where facets are evenly spread, those that are seen reflect into a cap. */
    const float3 seen = normalize((float3)(alpha * wo.x, alpha * wo.y, wo.z));
    const float z = (1.0f - u.y) * (1.0f + seen.z) - seen.z, across = sqrt(fmax(1.0f - z * z, 0.0f));
    const float3 facet = (float3)(across * cos(turn), across * sin(turn), z) + seen;
    const float3 h = normalize((float3)(alpha * facet.x, alpha * facet.y, facet.z));
    rt_surface_draw draw;
    draw.wi = normalize(2.0f * dot(wo, h) * h - wo);
    draw.pdf = 0.0f;
    draw.weight = (float3)(0.0f);
    if (draw.wi.z <= 0.0f) return draw;
    const float out = microfacet_smith(wo, alpha);
    draw.pdf = microfacet_pdf(numbers, color, wo, draw.wi);
    draw.weight = microfacet_fresnel(color, dot(wo, h)) * ((1.0f + out) / (out + microfacet_smith(draw.wi, alpha)));
    return draw;
}
