/* film.cl -- from the film to what a screen shows, and sums over the counters. A program of its own, built once a device. */

/* The sRGB curve by square roots instead of pow: off by less than half a step of 8 bits, and compiled in a fraction of the time. */
float16 rt_srgb_from_linear(float16 c)
{
    const float16 r2 = sqrt(c), r4 = sqrt(r2), r8 = sqrt(r4);
    const float16 curve = 0.662002687f * r2 + 0.684122060f * r4 - 0.323583601f * r8 - 0.0225411470f * c;
    return c < 0.0031308f ? 12.92f * c : curve;
}

/* Narkowicz 2015, ACES Filmic Tone Mapping Curve (a fit). */
float16 rt_aces(float16 x) { return clamp(x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f), 0.0f, 1.0f); }

/* film: sums of samples, w counts them. display: RGBA8, sRGB, top row first. tone: 0 linear (clipped), 1 Reinhard, 2 ACES-like. */
kernel void map_tones(const global float *film, global uchar *display, const uint count, const float exposure, const uint tone)
{
    const uint i = (uint)get_global_id(0);
    if (i >= count) return;
    const float16 sum = vload16(i, film);
    const float16 weight = max((float16)(sum.s3333, sum.s7777, sum.sbbbb, sum.sffff), 1.0f);
    float16 c = max(sum * (exposure / weight), 0.0f);
    if (tone == 1u) c = c / (1.0f + c);
    if (tone == 2u) c = rt_aces(c);
    const float16 s = clamp(rt_srgb_from_linear(min(c, 1.0f)), 0.0f, 1.0f) * 255.0f + 0.5f;
    const uchar16 alpha = (uchar16)(0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255);
    vstore16(convert_uchar16(s) | alpha, i, display);
}

/* sums: 4 zeroed uints. */
kernel void sum_counters(const global uint4 *counters, const uint count, global uint *sums)
{
    uint4 mine = (uint4)(0u);
    for (uint i = (uint)get_global_id(0); i < count; i += (uint)get_global_size(0)) mine += counters[i];
    if (mine.x) atomic_add(sums + 0, mine.x);
    if (mine.y) atomic_add(sums + 1, mine.y);
    if (mine.z) atomic_add(sums + 2, mine.z);
    if (mine.w) atomic_add(sums + 3, mine.w);
}
