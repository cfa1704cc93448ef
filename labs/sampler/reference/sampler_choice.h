/* sampler_choice.h -- our solution of the lab: either way as often as it brings light, and the density of both together, whichever was
 * taken: the balance heuristic for one draw (Veach, Guibas 1995, Optimally Combining Sampling Techniques for Monte Carlo Rendering). */

/* How often facets are drawn: by what the varnish and the paint send to wo. */
RT_INLINE float sampler_share(const global float *numbers, float3 color, float3 wo)
{
    const float varnish = sampler_fresnel(numbers, wo.z);
    /* 20/21: the mean of 1 - (1 - cosine)^5 over what is drawn by the cosine. */
    const float paint = (1.0f - varnish) * (1.0f - numbers[1]) * 0.95238095f * (color.x + color.y + color.z) / 3.0f;
    /* Each way has a share: else light that only the other one finds would be lost where an estimate is 0. */
    return clamp(varnish / fmax(varnish + paint, 1e-6f), 0.05f, 0.95f);
}

RT_INLINE float3 sampler_direction(const global float *numbers, float3 color, float3 wo, float3 u)
{
    return u.z < sampler_share(numbers, color, wo) ? sampler_facet_draw(sampler_alpha(numbers), wo, u.xy) : sampler_cosine_draw(u.xy);
}

RT_INLINE float sampler_pdf(const global float *numbers, float3 color, float3 wo, float3 wi)
{
    return mix(sampler_cosine_pdf(wi), sampler_facet_pdf(sampler_alpha(numbers), wo, wi), sampler_share(numbers, color, wo));
}
