/* oren_nayar.cl -- Fujii's form: color / pi * (1 + sigma s / t) / (1 + (1/2 - 2 / (3 pi)) sigma), in which s is the cosine between the
 * parts of the directions along the surface, times their sines. It sends back no more than it gets. */
RT_INLINE float3 oren_nayar_eval(const global float *numbers, float3 color, float3 wo, float3 wi)
{
    const float sigma = numbers[0], s = wo.x * wi.x + wo.y * wi.y, t = s > 0.0f ? fmax(wo.z, wi.z) : 1.0f;
    return (1.0f + sigma * s / t) / (1.0f + 0.28779342f * sigma) * 0.31830989f * color;
}

RT_INLINE float oren_nayar_pdf(const global float *numbers, float3 color, float3 wo, float3 wi) { return wi.z * 0.31830989f; }

/* By the cosine: Malley's method. */
RT_INLINE rt_surface_draw oren_nayar_sample(const global float *numbers, float3 color, float3 wo, float3 u)
{
    const float radius = sqrt(u.x), turn = 6.2831853f * u.y;
    rt_surface_draw draw;
    draw.wi = (float3)(radius * cos(turn), radius * sin(turn), sqrt(fmax(1.0f - u.x, 0.0f)));
    draw.pdf = oren_nayar_pdf(numbers, color, wo, draw.wi);
    draw.weight = 3.1415927f * oren_nayar_eval(numbers, color, wo, draw.wi);
    return draw;
}
