/* nurbs.cl -- one ray against one rational Bezier patch.
 *
 * Two planes contain the ray. A point of the patch lies on the ray where its distances from both are 0, and these, multiplied by the
 * weights, are Bezier polynomials a(u, v) and b(u, v) (Nishita, Sederberg, Kakimoto 1990, "Ray Tracing Trimmed Rational Surface
 * Patches"). Pieces of the patch are dropped where the hull of their coefficients excludes 0. A piece on which the derivatives of a
 * and b change little has one root at most (Krawczyk's test), which Newton's method finds. Other pieces are halved. At silhouettes,
 * where a root is double, that ends at a piece of a thousandth of the patch, which counts as hit: so no root is missed.
 *
 * numbers: degrees, ranges of the surface's parameters, a point in the middle. more: the points, relative to that, with weights. */
#define NURBS_SIDE 6       /* greatest degree + 1 */
#define NURBS_STACK 24
#define NURBS_STEPS 512    /* pieces of one patch, at most */
#define NURBS_SMALLEST (1.0f / 1024.0f)
#define NURBS_BORDER 1e-4f /* pieces overlap by this share of their width, so that rounding leaves no gap */
#define NURBS_BESIDE 1e-3f /* a root is at most this share of the patch's size beside the ray */

/* The surface, times its weight, and derivatives by u and v. */
typedef struct nurbs_jet {
    float4 at, du, dv;
} nurbs_jet;

/* De Casteljau's algorithm on `degree` + 1 values, down to the last two. */
RT_INLINE void nurbs_reduce(float4 *values, uint degree, float x)
{
    for (uint r = 1; r < degree; ++r)
        for (uint i = 0; i <= degree - r; ++i) values[i] = fma((float4)(x), values[i + 1u] - values[i], values[i]);
}

RT_INLINE nurbs_jet nurbs_evaluate(const global float *more, uint p, uint q, float u, float v)
{
#pragma OPENCL FP_CONTRACT OFF
    float4 row[NURBS_SIDE], column[NURBS_SIDE], slope[NURBS_SIDE];
    for (uint i = 0; i <= p; ++i) {
        for (uint j = 0; j <= q; ++j) row[j] = vload4(i * (q + 1u) + j, more);
        nurbs_reduce(row, q, v);
        slope[i] = (float)q * (row[1] - row[0]);
        column[i] = fma((float4)(v), row[1] - row[0], row[0]);
    }
    nurbs_reduce(column, p, u);
    nurbs_reduce(slope, p, u);
    nurbs_jet jet;
    jet.du = (float)p * (column[1] - column[0]);
    jet.at = fma((float4)(u), column[1] - column[0], column[0]);
    jet.dv = fma((float4)(u), slope[1] - slope[0], slope[0]);
    return jet;
}

/* Cuts a row of `degree` + 1 coefficients, `stride` apart, to the range from..to. */
RT_INLINE void nurbs_cut(float2 *row, uint degree, uint stride, float from, float to)
{
    if (to < 1.0f)
        for (uint r = 1; r <= degree; ++r)
            for (uint i = degree; i >= r; --i)
                row[i * stride] = fma((float2)(to), row[i * stride] - row[(i - 1u) * stride], row[(i - 1u) * stride]);
    if (from > 0.0f)
        for (uint r = 1; r <= degree; ++r)
            for (uint i = 0; i <= degree - r; ++i)
                row[i * stride] = fma((float2)(from / to), row[(i + 1u) * stride] - row[i * stride], row[i * stride]);
}

/* Whether a hull of coefficients contains 0, with some slack. */
RT_INLINE int nurbs_around_zero(const float2 *net, uint count, float slack)
{
    float2 low = net[0], high = net[0], low_turned, high_turned;
    low_turned = high_turned = (float2)(net[0].x + net[0].y, net[0].x - net[0].y);
    for (uint i = 1; i < count; ++i) {
        const float2 turned = (float2)(net[i].x + net[i].y, net[i].x - net[i].y);
        low = min(low, net[i]);
        high = max(high, net[i]);
        low_turned = min(low_turned, turned);
        high_turned = max(high_turned, turned);
    }
    return max(low.x, low.y) <= slack && min(high.x, high.y) >= -slack && max(low_turned.x, low_turned.y) <= 2.0f * slack &&
           min(high_turned.x, high_turned.y) >= -2.0f * slack;
}

/* The ray's line in the patch's space. */
typedef struct nurbs_line {
    float3 origin, along, across_a, across_b; /* all but the origin are unit vectors */
} nurbs_line;

/* A step of Newton's method at `jet`: what is to be added to (u, v). 0 where there is none. */
RT_INLINE float2 nurbs_newton(const nurbs_line *line, nurbs_jet jet)
{
#pragma OPENCL FP_CONTRACT OFF
    const float3 at = jet.at.xyz - jet.at.w * line->origin, du = jet.du.xyz - jet.du.w * line->origin, dv = jet.dv.xyz - jet.dv.w * line->origin;
    const float a = dot(line->across_a, at), b = dot(line->across_b, at);
    const float a_u = dot(line->across_a, du), a_v = dot(line->across_a, dv), b_u = dot(line->across_b, du), b_v = dot(line->across_b, dv);
    const float det = a_u * b_v - a_v * b_u;
    if (det == 0.0f) return (float2)(0.0f);
    return (float2)(a_v * b - b_v * a, b_u * a - a_u * b) / det;
}

/* Derivatives of (a, b) over a piece, as differences of neighbouring coefficients: their mean, and the longest one. */
typedef struct nurbs_slopes {
    float2 du, dv;
    float longest_u, longest_v;
} nurbs_slopes;

RT_INLINE nurbs_slopes nurbs_slopes_of(const float2 *net, uint p, uint q)
{
    nurbs_slopes s;
    s.du = s.dv = (float2)(0.0f);
    s.longest_u = s.longest_v = 0.0f;
    for (uint i = 0; i <= p; ++i)
        for (uint j = 0; j <= q; ++j) {
            const float2 here = net[i * (q + 1u) + j];
            if (i < p) {
                const float2 leg = (float)p * (net[(i + 1u) * (q + 1u) + j] - here);
                s.du += leg / (float)(p * (q + 1u));
                s.longest_u = max(s.longest_u, dot(leg, leg));
            }
            if (j < q) {
                const float2 leg = (float)q * (net[i * (q + 1u) + j + 1u] - here);
                s.dv += leg / (float)(q * (p + 1u));
                s.longest_v = max(s.longest_v, dot(leg, leg));
            }
        }
    return s;
}

/* How far the derivatives differ from their means, in units of the means: below 1, the piece has one root at most. */
RT_INLINE float nurbs_spread(const float2 *net, uint p, uint q, const nurbs_slopes *s)
{
    const float det = s->du.x * s->dv.y - s->dv.x * s->du.y;
    if (fabs(det) <= 1e-3f * sqrt(s->longest_u * s->longest_v) || det == 0.0f) return 2.0f;
    const float2 to_u = (float2)(s->dv.y, -s->dv.x) / det, to_v = (float2)(-s->du.y, s->du.x) / det;
    float2 spread_u = (float2)(0.0f), spread_v = (float2)(0.0f);
    for (uint i = 0; i <= p; ++i)
        for (uint j = 0; j <= q; ++j) {
            const float2 here = net[i * (q + 1u) + j];
            if (i < p) {
                const float2 leg = (float)p * (net[(i + 1u) * (q + 1u) + j] - here);
                spread_u = max(spread_u, fabs((float2)(dot(to_u, leg) - 1.0f, dot(to_v, leg))));
            }
            if (j < q) {
                const float2 leg = (float)q * (net[i * (q + 1u) + j + 1u] - here);
                spread_v = max(spread_v, fabs((float2)(dot(to_u, leg), dot(to_v, leg) - 1.0f)));
            }
        }
    return max(spread_u.x + spread_v.x, spread_u.y + spread_v.y);
}

RT_INLINE float nurbs_hit(const global float *numbers, const global float *more, const rt_shape_ray *ray, float *u, float *v)
{
#pragma OPENCL FP_CONTRACT OFF
    const uint p = (uint)numbers[0], q = (uint)numbers[1], count = (p + 1u) * (q + 1u);
    nurbs_line line;
    const float length2 = dot(ray->direction, ray->direction);
    line.origin = ray->origin - (float3)(numbers[6], numbers[7], numbers[8]);
    line.along = ray->direction / sqrt(length2);
    const float3 d = line.along;
    line.across_a = normalize(fabs(d.x) > fabs(d.z) ? (float3)(-d.y, d.x, 0.0f) : (float3)(0.0f, -d.z, d.y));
    line.across_b = cross(d, line.across_a);

    float2 whole[NURBS_SIDE * NURBS_SIDE], net[NURBS_SIDE * NURBS_SIDE];
    float size = 0.0f;
    for (uint i = 0; i < count; ++i) {
        const float4 point = vload4(i, more);
        const float3 from = point.xyz - point.w * line.origin;
        whole[i] = (float2)(dot(line.across_a, from), dot(line.across_b, from));
        size = max(size, max(fabs(whole[i].x), fabs(whole[i].y)));
    }
    const float slack = 16.0f * RT_EPS * size;
    float nearest = INFINITY;
    float4 pieces[NURBS_STACK]; /* ranges of u and v */
    pieces[0] = (float4)(0.0f, 1.0f, 0.0f, 1.0f);
    uint top = 1;
    for (uint step = 0; top > 0u && step < NURBS_STEPS; ++step) {
        const float4 piece = pieces[--top];
        for (uint i = 0; i < count; ++i) net[i] = whole[i];
        for (uint j = 0; j <= q; ++j) nurbs_cut(net + j, p, q + 1u, piece.x, piece.y);
        for (uint i = 0; i <= p; ++i) nurbs_cut(net + i * (q + 1u), q, 1u, piece.z, piece.w);
        if (!nurbs_around_zero(net, count, slack)) continue;

        const nurbs_slopes slopes = nurbs_slopes_of(net, p, q);
        const float2 width = (float2)(piece.y - piece.x, piece.w - piece.z);
        float2 at = (float2)(piece.x, piece.z) + 0.5f * width;
        int found = 0;
        if (nurbs_spread(net, p, q, &slopes) < 0.75f) {
            for (uint i = 0; i < 8u; ++i) {
                const float2 next = at + nurbs_newton(&line, nurbs_evaluate(more, p, q, at.x, at.y));
                at = clamp(next, (float2)(piece.x, piece.z) - 0.5f * width, (float2)(piece.y, piece.w) + 0.5f * width);
            }
            const float2 beyond = max((float2)(piece.x, piece.z) - at, at - (float2)(piece.y, piece.w));
            if (beyond.x > NURBS_BORDER * width.x || beyond.y > NURBS_BORDER * width.y) continue;
            at = clamp(at, (float2)(piece.x, piece.z), (float2)(piece.y, piece.w));
            /* Where there is no root, Newton's method may end anywhere in the piece. */
            const float4 point = nurbs_evaluate(more, p, q, at.x, at.y).at;
            const float3 from = point.xyz - point.w * line.origin;
            found = max(fabs(dot(line.across_a, from)), fabs(dot(line.across_b, from))) <= NURBS_BESIDE * size;
        }
        if (!found && (max(width.x, width.y) <= NURBS_SMALLEST || top + 2u > NURBS_STACK)) found = 1;
        if (found) {
            const float4 point = nurbs_evaluate(more, p, q, at.x, at.y).at;
            const float t = dot(line.along, point.xyz / point.w - line.origin) / sqrt(length2);
            if (t >= ray->t_min && t < nearest) {
                nearest = t;
                *u = at.x;
                *v = at.y;
            }
            continue;
        }
        const float2 middle = (float2)(piece.x, piece.z) + 0.5f * width;
        const int halve_u = width.y <= NURBS_SMALLEST || (width.x > NURBS_SMALLEST && slopes.longest_u >= slopes.longest_v);
        pieces[top++] = halve_u ? (float4)(middle.x, piece.y, piece.zw) : (float4)(piece.xy, middle.y, piece.w);
        pieces[top++] = halve_u ? (float4)(piece.x, middle.x, piece.zw) : (float4)(piece.xy, piece.z, middle.y);
    }
    return nearest;
}

RT_INLINE void nurbs_surface(const global float *numbers, const global float *more, float3 at, float u, float v, rt_shape_point *s)
{
#pragma OPENCL FP_CONTRACT OFF
    const uint p = (uint)numbers[0], q = (uint)numbers[1];
    nurbs_jet jet = nurbs_evaluate(more, p, q, u, v);
    const float3 point = jet.at.xyz / jet.at.w;
    for (uint i = 0;; ++i) {
        const float3 here = jet.at.xyz / jet.at.w, du = jet.du.xyz - jet.du.w * here, dv = jet.dv.xyz - jet.dv.w * here;
        s->normal = cross(du, dv);
        /* Where an edge is one point there is no normal. Take one a little farther inside. */
        if (i == 4u || dot(s->normal, s->normal) > 1e-8f * dot(du, du) * dot(dv, dv)) break;
        u += (0.5f - u) * 0.01f;
        v += (0.5f - v) * 0.01f;
        jet = nurbs_evaluate(more, p, q, u, v);
    }
    const float length2 = dot(s->normal, s->normal);
    s->normal = length2 > 0.0f ? s->normal / sqrt(length2) : (float3)(0.0f, 1.0f, 0.0f);
    s->height = dot(s->normal, at - (float3)(numbers[6], numbers[7], numbers[8]) - point);
    s->error *= 4.0f;
    s->tex_u = mix(numbers[2], numbers[3], u);
    s->tex_v = mix(numbers[4], numbers[5], v);
}
#undef NURBS_SIDE
#undef NURBS_STACK
#undef NURBS_STEPS
#undef NURBS_SMALLEST
#undef NURBS_BORDER
#undef NURBS_BESIDE
