/* film.cl -- makes the picture that a screen shows from the film, and sums the counters. A program of its own, built once a
 * device. */

/* Tone curves work on four pixels at a time, r g b w each; w is computed along and not used. Sums and products are written as
 * operators, because built-in functions need not accept a scalar beside a vector. The compiler fuses them. */

/* The sRGB curve as a polynomial of the square root. Its error is a twelfth of a step of 8 bits, its time a fraction of
 * pow's. */
float16 rt_srgb_from_linear(float16 c)
{
    const float16 r = sqrt(c);
    const float16 curve =
        ((((0.517203218f * r - 1.62340351f) * r + 2.03134164f) * r - 1.40264541f) * r + 1.51793663f) * r - 0.0401089663f;
    return c < 0.0031308f ? 12.92f * c : curve;
}

/* Narkowicz 2015, "ACES Filmic Tone Mapping Curve" (a fit). */
float16 rt_aces(float16 x) { return clamp(x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f), 0.0f, 1.0f); }

/* A curve like AgX (Sobotka 2022, github.com/sobotka/AgX). Primaries are moved towards each other, so that bright colours turn
 * white and not to a neighbouring hue. Then a sigmoid over 16.5 stops, 10 below middle grey and 6.5 above, gives the display's
 * code. Here primaries are moved by a fifth towards the mean of the three, which is simpler than the original's matrix. The
 * polynomial is our fit of the original's curve (pivot 0.5, slope 2, powers 3 for the toe and 3.25 for the shoulder). It rises
 * throughout and is within 1/255. */
float16 rt_agx(float16 c)
{
    const float4 mean = (c.s048c + c.s159d + c.s26ae) * (1.0f / 3.0f);
    c = 0.8f * c + 0.2f * (float16)(mean.s0000, mean.s1111, mean.s2222, mean.s3333);
    const int16 bits = as_int16(max(c, 1e-10f));
    const float16 m = as_float16((bits & 0x007fffff) | 0x3f800000) - 1.0f;
    const float16 log2_c = convert_float16((bits >> 23) - 127) +
                           (((-0.0816144302f * m + 0.31867642f) * m - 0.674941239f) * m + 1.43770407f) * m;
    const float16 x = clamp(log2_c * (1.0f / 16.5f) + (10.0f + 2.47393119f) / 16.5f, 0.0f, 1.0f);
    const float16 curve = ((((15.3345458f * x - 39.0954494f) * x + 30.0148278f) * x - 5.34871081f) * x - 0.0777287038f) * x;
    return (curve + 0.178789123f) * x - 0.00313757338f;
}

/* Maps the i-th quadruple of pixels. */
void rt_map_tones(const global float *film, global uchar *display, const uint i, const float exposure, const uint tone)
{
    const float16 sum = vload16(i, film);
    const float4 scale = exposure / max(sum.s37bf, 1.0f);
    float16 c = max(sum * (float16)(scale.s0000, scale.s1111, scale.s2222, scale.s3333), 0.0f);
    if (tone == 1u) c = c / (1.0f + c);
    if (tone == 2u) c = rt_aces(c);
    const float16 code = tone == 3u ? rt_agx(c) : rt_srgb_from_linear(min(c, 1.0f));
    const float16 s = clamp(code, 0.0f, 1.0f) * 255.0f + 0.5f;
    const uchar16 alpha = (uchar16)(0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255);
    vstore16(convert_uchar16(s) | alpha, i, display);
}

/* film: the sums of samples, with their number in w. display: RGBA8, sRGB, top row first. count: the number of quadruples of
 * pixels. tone: 0 linear (clipped), 1 Reinhard, 2 ACES-like, 3 AgX-like. */
kernel void map_tones(const global float *film, global uchar *display, const uint count, const float exposure, const uint tone)
{
    const uint i = (uint)get_global_id(0);
    if (i < count) rt_map_tones(film, display, i, exposure, tone);
}

/* The same for some rows of work-groups. rows: their numbers. row_pixels: the pixels of one row. row_quads: the greatest number of
 * quadruples that a row touches. Where row_pixels is no multiple of 4, neighbouring rows share quadruples, and two work-items
 * may write the same bytes. items: row_quads times the number of rows. */
kernel void map_tones_of_rows(const global float *film, global uchar *display, const uint count, const float exposure,
                              const uint tone, const global uint *rows, const uint row_pixels, const uint row_quads,
                              const uint items)
{
    const uint item = (uint)get_global_id(0);
    if (item >= items) return;
    const uint i = rows[item / row_quads] * row_pixels / 4u + item % row_quads;
    if (i < count) rt_map_tones(film, display, i, exposure, tone);
}

/* Adds a launch's layers (rt_types.h) to the film, in order, for some rows of work-groups of row_pixels pixels each. items: the
 * number of pixels in all of these rows. adds: 0: the first layer replaces the film. */
kernel void add_layers(global float4 *film, const global float4 *layers, const uint pixels, const uint layer_count, const uint adds,
                       const global uint *rows, const uint row_pixels, const uint items)
{
    const uint item = (uint)get_global_id(0);
    if (item >= items) return;
    const uint i = rows[item / row_pixels] * row_pixels + item % row_pixels;
    if (i >= pixels) return;
    float4 sum = layers[i];
    if (adds != 0u) sum = film[i] + sum;
    for (uint layer = 1; layer < layer_count; ++layer) sum += layers[(size_t)layer * pixels + i];
    film[i] = sum;
}

#define RT_SUMMERS 64u

/* Adds to a number of 64 bits, low half first, because OpenCL 1.2 promises only atomics of 32 bits. */
void rt_add_wide(volatile global uint *sum, const ulong value)
{
    const uint low = (uint)value, before = atomic_add(sum, low);
    const uint high = (uint)(value >> 32) + (before + low < before ? 1u : 0u);
    if (high != 0u) atomic_add(sum + 1, high);
}

/* A work-group's share of a sum into all of it. On a GPU a packet is a pixel, so a group adds up its own first. */
void rt_add_group(local ulong4 *of_items, const ulong4 mine, volatile global uint *sums)
{
    const uint lane = (uint)get_local_id(0);
    of_items[lane] = mine;
    for (uint half_of = RT_SUMMERS / 2u; half_of > 0u; half_of /= 2u) {
        barrier(CLK_LOCAL_MEM_FENCE);
        if (lane < half_of) of_items[lane] += of_items[lane + half_of];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (lane >= 4u) return;
    const ulong sum = ((const local ulong *)of_items)[lane];
    if (sum != 0u) rt_add_wide(sums + 2u * lane, sum);
}

/* counters: of each packet 4 numbers of 32 bits; their sums may need 64. sums: 4 zeroed numbers, see rt_add_wide(). */
kernel __attribute__((reqd_work_group_size(RT_SUMMERS, 1, 1))) void
sum_counters(const global uint4 *counters, const uint count, volatile global uint *sums)
{
    local ulong4 of_items[RT_SUMMERS];
    ulong4 mine = (ulong4)(0u);
    for (uint i = (uint)get_global_id(0); i < count; i += (uint)get_global_size(0)) mine += convert_ulong4(counters[i]);
    rt_add_group(of_items, mine, sums);
}

/* The same of counters that are 64 bits wide themselves. */
kernel __attribute__((reqd_work_group_size(RT_SUMMERS, 1, 1))) void
sum_wide_counters(const global ulong4 *counters, const uint count, volatile global uint *sums)
{
    local ulong4 of_items[RT_SUMMERS];
    ulong4 mine = (ulong4)(0u);
    for (uint i = (uint)get_global_id(0); i < count; i += (uint)get_global_size(0)) mine += counters[i];
    rt_add_group(of_items, mine, sums);
}
