/* my_surface.cl -- Minnaert's surface (1941, The Reciprocity Principle in Lunar Photometry): the cosines of both directions have the
 * exponent k - 1. One ray at a time; directions are unit vectors away from the surface, and z is its normal. numbers: those of the keys. */

/* f, without a cosine: the same if wo and wi change places. */
RT_INLINE float3 my_surface_eval(const global float *numbers, float3 color, float3 wo, float3 wi)
{
    const float k = numbers[0];
    return color * (0.15915494f * (k + 1.0f) * powr(wo.z * wi.z, k - 1.0f));
}

/* The density of what my_surface_sample draws, 1/sr. Its integral over the hemisphere is 1. */
RT_INLINE float my_surface_pdf(const global float *numbers, float3 color, float3 wo, float3 wi)
{
    const float k = numbers[0];
    return 0.15915494f * (k + 1.0f) * powr(wi.z, k);
}

/* Draws a direction. u: three independent numbers in [0, 1). */
RT_INLINE rt_surface_draw my_surface_sample(const global float *numbers, float3 color, float3 wo, float3 u)
{
    const float k = numbers[0], turn = 6.2831853f * u.x;
    const float z = powr(1.0f - u.y, 1.0f / (k + 1.0f)), across = sqrt(fmax(1.0f - z * z, 0.0f));
    rt_surface_draw draw;
    draw.wi = (float3)(across * cos(turn), across * sin(turn), z);
    draw.pdf = my_surface_pdf(numbers, color, wo, draw.wi);
    draw.weight = color * powr(wo.z, k - 1.0f); /* f cos / pdf */
    return draw;
}
