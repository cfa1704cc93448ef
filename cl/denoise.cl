/* denoise.cl -- filters the noise out of a film of `path`. A program of its own, built when it is first asked for.
 *
 * Dammertz et al. 2010, Edge-Avoiding A-Trous Wavelet Transform for fast Global Illumination Filtering; the tolerance of luminance is
 * that of Schied et al. 2017, Spatiotemporal Variance-Guided Filtering, with the variance that the film has measured, and without
 * pictures of earlier times. Textures are divided out before, and light that comes to the camera without scattering is set apart
 * (cl/tracers/path/guides.h), so both stay as they are. The filter is narrow where the film is sure of itself: the picture goes to the one
 * without the filter as samples are added.
 *
 * Pixels that are no number stay so, and give nothing to others. Weights end at 0 and not in a tail, so that nothing comes through an
 * edge that is clear. */

/* Albedos are taken to be at least this, for the division. */
#define RT_LEAST_ALBEDO 0.02f
/* Standard errors by which luminances may differ. */
#define RT_LUMINANCE_ERRORS 4.0f
/* 1 / square of the difference of unit normals at which a weight has fallen to a third. */
#define RT_NORMAL_SCALE 40.0f
/* The share of a depth by which depths may differ, besides by the slope of the surface. */
#define RT_DEPTH_SHARE 0.02f
/* A pixel of an edge shows a mixture that few neighbours are like. If their weights are below this, those are taken, too, that are less
 * alike: by this factor, and at steps of no more pixels than this. */
#define RT_ALONE 3.0f
#define RT_LOOSE 0.1f
#define RT_LOOSE_STEP 2
/* How far away variances are averaged, in pixels. */
#define RT_NEAR 2

/* The pixel i of a plane of the film. */
#define RT_OF_PLANE(plane) film[(plane) * (size_t)pixels + i]

float rt_luminance(const float3 c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }
bool rt_is_broken(const float x) { return (as_uint(x) & 0x7f800000u) == 0x7f800000u; }

/* Nearly exp(-x), but 0 from x = 8 on. */
float rt_fall(const float x)
{
    float w = max(1.0f - 0.125f * x, 0.0f);
    w *= w;
    w *= w;
    return w * w;
}

/* What the light of a pixel is divided by. albedo: a sum of `count` samples. */
float3 rt_divisor(const float4 albedo, const float count) { return max(albedo.xyz / count, RT_LEAST_ALBEDO); }

/* By how much depths and normals of two pixels speak against a common surface. slope: of the first pixel's inverse depth. */
float rt_apart(const float4 guide, const float4 other, const float2 slope, const int dx, const int dy)
{
    const float3 turned = other.xyz - guide.xyz;
    const float expected = slope.x * (float)dx + slope.y * (float)dy;
    /* Half a pixel either way, as samples lie anywhere in their pixels. */
    const float allowed = RT_DEPTH_SHARE * guide.w + fabs(slope.x) + fabs(slope.y) + 1e-30f;
    return RT_NORMAL_SCALE * dot(turned, turned) + fabs(other.w - guide.w - expected) / allowed;
}

/* The smaller of the differences to both neighbours: that on the pixel's own side of an edge. */
float rt_slope(const float before, const float at, const float after)
{
    const float left = at - before, right = after - at;
    return fabs(left) < fabs(right) ? left : right;
}
float2 rt_slopes(const global float4 *guides, const int x, const int y, const int width, const int height)
{
    const global float4 *row = guides + (size_t)y * width;
    const float at = row[x].w;
    const float across = width > 1 ? rt_slope(row[max(x - 1, 0)].w, at, row[min(x + 1, width - 1)].w) : 0.0f;
    const float along = height > 1 ? rt_slope(guides[(size_t)max(y - 1, 0) * width + x].w, at,
                                              guides[(size_t)min(y + 1, height - 1) * width + x].w)
                                   : 0.0f;
    return (float2)(across, along);
}

/* light: of each pixel the mean of what surfaces scatter, divided by their albedo, and the variance of its luminance; below 0: not
 * known, of one sample; not a number: the pixel is broken. guides: normal and inverse depth, means of samples. */
kernel void split_light(const global float4 *film, const uint pixels, global float4 *light, global float4 *guides)
{
    const uint i = (uint)get_global_id(0);
    if (i >= pixels) return;
    const float4 sum = RT_OF_PLANE(RT_PLANE_SUM), rest = RT_OF_PLANE(RT_PLANE_REST), own = RT_OF_PLANE(RT_PLANE_OWN),
                 albedo = RT_OF_PLANE(RT_PLANE_ALBEDO), normal = RT_OF_PLANE(RT_PLANE_NORMAL);
    const float count = max(sum.w, 1.0f);
    const float3 by = rt_divisor(albedo, count);
    const float3 scattered = (sum.xyz - own.xyz) / count / by;
    const float divided = rt_luminance(by);
    float variance = count > 1.0f ? fabs(rest.w) / ((count - 1.0f) * count * divided * divided) : -1.0f;
    const float all = scattered.x + scattered.y + scattered.z + normal.x + normal.y + normal.z + own.w;
    if (rt_is_broken(all) || rt_is_broken(variance)) variance = NAN;
    light[i] = (float4)(scattered, variance);
    guides[i] = (float4)(normal.xyz, own.w) / count;
}

/* Few samples may be alike by chance, as all that are black are. So the variance of a pixel is taken to be at least the mean of those
 * around it on the same surface; if it is not known, what luminances there differ by. The sign says whether the pixel is alone. */
kernel void smooth_variances(const global float4 *light, const global float4 *guides, const int width, const int height, global float4 *out)
{
    const uint i = (uint)get_global_id(0);
    if (i >= (uint)(width * height)) return;
    const int x = (int)i % width, y = (int)i / width;
    const float4 mine = light[i], guide = guides[i];
    const float2 slope = rt_slopes(guides, x, y, width, height);
    const float center = rt_luminance(mine.xyz);
    float4 alike = (float4)(0.0f), loose = (float4)(0.0f); /* sums of weights, and of variances, luminances and their squares */
    for (int dy = -RT_NEAR; dy <= RT_NEAR; ++dy)
        for (int dx = -RT_NEAR; dx <= RT_NEAR; ++dx) {
            const int at_x = x + dx, at_y = y + dy;
            const bool inside = at_x >= 0 && at_x < width && at_y >= 0 && at_y < height;
            const size_t at = (size_t)clamp(at_y, 0, height - 1) * width + clamp(at_x, 0, width - 1);
            const float4 other = light[at], its = guides[at];
            const bool counts = inside && !rt_is_broken(other.w);
            /* Differences to the pixel's own luminance, so that no digits cancel. */
            const float differs = counts ? rt_luminance(other.xyz) - center : 0.0f;
            const float4 values = (float4)(1.0f, counts ? max(other.w, 0.0f) : 0.0f, differs, differs * differs);
            const float apart = rt_apart(guide, its, slope, dx, dy);
            alike += (counts ? rt_fall(apart) : 0.0f) * values;
            loose += (counts && its.w > 0.0f ? rt_fall(RT_LOOSE * apart) : 0.0f) * values;
        }
    const bool alone = alike.x < RT_ALONE && guide.w > 0.0f;
    float4 mean = alone ? loose : alike;
    mean /= max(mean.x, 1e-20f);
    const float variance = mine.w < 0.0f ? max(mean.w - mean.z * mean.z, 0.0f) : max(mine.w, mean.y);
    out[i] = (float4)(mine.xyz, rt_is_broken(mine.w) ? mine.w : alone ? -variance : variance);
}

/* One level of the wavelet: 5x5 pixels, `step` pixels apart. */
kernel void filter_level(const global float4 *light, const global float4 *guides, const int width, const int height, const int step,
                         global float4 *out)
{
    const uint i = (uint)get_global_id(0);
    if (i >= (uint)(width * height)) return;
    const int x = (int)i % width, y = (int)i / width;
    const float4 mine = light[i], guide = guides[i];
    if (rt_is_broken(mine.w)) {
        out[i] = mine;
        return;
    }
    const float2 slope = rt_slopes(guides, x, y, width, height);
    /* The variance of 3x3 pixels, so that one of them alone decides nothing. */
    float around = 0.0f, shares = 0.0f;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            const size_t at = (size_t)clamp(y + dy, 0, height - 1) * width + clamp(x + dx, 0, width - 1);
            const float variance = fabs(light[at].w);
            const float share = rt_is_broken(variance) ? 0.0f : (dx == 0 ? 2.0f : 1.0f) * (dy == 0 ? 2.0f : 1.0f);
            around += share > 0.0f ? share * variance : 0.0f;
            shares += share;
        }
    const float luminance = rt_luminance(mine.xyz);
    const float unlike = 1.0f / (RT_LUMINANCE_ERRORS * sqrt(around / shares) + 1e-5f * fabs(luminance) + 1e-20f);
    const bool alone = mine.w < 0.0f && step <= RT_LOOSE_STEP;
    float3 sum = (float3)(0.0f);
    float variance = 0.0f, weights = 0.0f;
    for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx) {
            const int at_x = x + dx * step, at_y = y + dy * step;
            const bool inside = at_x >= 0 && at_x < width && at_y >= 0 && at_y < height;
            const size_t at = (size_t)clamp(at_y, 0, height - 1) * width + clamp(at_x, 0, width - 1);
            const float4 other = light[at], its = guides[at];
            const float spline = (dx == 0 ? 0.375f : dx * dx == 1 ? 0.25f : 0.0625f) * (dy == 0 ? 0.375f : dy * dy == 1 ? 0.25f : 0.0625f);
            const float apart = rt_apart(guide, its, slope, dx * step, dy * step);
            const float differs = fabs(rt_luminance(other.xyz) - luminance) * unlike + (alone ? RT_LOOSE * apart : apart);
            const bool counts = inside && !rt_is_broken(other.w) && (!alone || its.w > 0.0f);
            const float w = counts ? spline * rt_fall(differs) : 0.0f;
            sum += w * (counts ? other.xyz : (float3)(0.0f));
            variance += w * w * (counts ? fabs(other.w) : 0.0f);
            weights += w;
        }
    out[i] = (float4)(sum / weights, copysign(variance / (weights * weights), mine.w));
}

/* The film without its noise, as of one sample. */
kernel void join_light(const global float4 *film, const uint pixels, const global float4 *light, global float4 *out)
{
    const uint i = (uint)get_global_id(0);
    if (i >= pixels) return;
    const float4 sum = RT_OF_PLANE(RT_PLANE_SUM), filtered = light[i];
    const float count = max(sum.w, 1.0f);
    const float3 own = RT_OF_PLANE(RT_PLANE_OWN).xyz / count;
    const float3 whole = rt_is_broken(filtered.w) ? sum.xyz / count : filtered.xyz * rt_divisor(RT_OF_PLANE(RT_PLANE_ALBEDO), count) + own;
    out[i] = (float4)(whole, 1.0f);
}
