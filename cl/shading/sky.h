/* sky.h -- the light that comes from beyond the scene: constant, a gradient, or a picture.
 *
 * A direction d sees the point u = 1/2 + atan2(d.z, d.x) / 2 pi, v = acos(d.y) / pi of a picture, v from the top: +X is in the middle, +Z a
 * quarter to the right of it. Between the middles of texels the radiance is bilinear; it repeats along u. Directions are drawn by rows and
 * then by cells of a row (ctx->sky_picks: running sums of shares of RT_PICKS), evenly in u and v within a cell. Directions to a gradient
 * are drawn in proportion to its mean color, by inversion. */
#ifndef RT_SKY_H
#define RT_SKY_H

#ifdef RT_HAS_SKY_PICTURE
/* Where directions are in the picture, and the sine of their angle to the zenith. */
RT_INLINE void rt_sky_place(const global rt_lighting *sky, rt_vec d, vfloat *u, vfloat *v, vfloat *sine)
{
    *sine = sqrt(fma(d.x, d.x, d.z * d.z));
    const vfloat turns = fma(rt_atan2(d.z, d.x), rt_vfloat(0.5f * RT_INVERSE_PI), rt_vfloat(0.5f + sky->sky_turn));
    *u = turns - floor(turns);
    *v = rt_atan2(*sine, d.y) * rt_vfloat(RT_INVERSE_PI); /* acos would lose digits at the poles */
}

/* The density of u and v per unit of both: how many of RT_PICKS have the cell. */
RT_INLINE float rt_sky_share(const global uint *sums, uint width, uint height, uint row, uint column)
{
    const global uint *cells = sums + (height + 1u) + row * (width + 1u);
    return (float)(sums[row + 1u] - sums[row]) * (1.0f / RT_PICKS) * (float)height * (float)(cells[column + 1u] - cells[column]) *
           (1.0f / RT_PICKS) * (float)width;
}

RT_INLINE vfloat rt_sky_density_of_place(vfloat share, vfloat sine)
{
    return share / (rt_vfloat(2.0f * RT_PI * RT_PI) * rt_max(sine, rt_vfloat(1e-9f)));
}

RT_INLINE rt_vec rt_sky_picture(const rt_ctx *ctx, rt_vec direction, vmask lanes, vfloat *density)
{
    const global rt_lighting *sky = ctx->lighting;
    const global half *texels = (const global half *)ctx->sky_texels;
    const int w = (int)sky->sky_width, h = (int)sky->sky_height;
    vfloat u, v, sine;
    rt_sky_place(sky, direction, &u, &v, &sine);
    const vfloat x = fma(u, rt_vfloat((float)w), rt_vfloat(-0.5f)), y = fma(v, rt_vfloat((float)h), rt_vfloat(-0.5f));
    const vfloat left = floor(x), above = floor(y);
    int column[RT_LANES], row[RT_LANES], cell_column[RT_LANES], cell_row[RT_LANES];
    float fx[RT_LANES], fy[RT_LANES], share[RT_LANES], red[RT_LANES], green[RT_LANES], blue[RT_LANES];
    rt_store(rt_to_int(left), column);
    rt_store(rt_to_int(above), row);
    rt_store(rt_to_int(u * rt_vfloat((float)w)), cell_column);
    rt_store(rt_to_int(v * rt_vfloat((float)h)), cell_row);
    rt_store(x - left, fx);
    rt_store(y - above, fy);
    const uint bits = rt_bits(lanes);
    for (uint l = 0; l < RT_LANES; ++l) {
        red[l] = green[l] = blue[l] = share[l] = 0.0f;
        if (!(bits >> l & 1u)) continue;
        for (int k = 0; k < 4; ++k) {
            const int dx = k & 1, dy = k >> 1, at_x = column[l] + dx, at_y = min(max(row[l] + dy, 0), h - 1);
            const ulong texel = 3ul * ((ulong)at_y * (ulong)w + (ulong)(at_x < 0 ? at_x + w : at_x >= w ? at_x - w : at_x));
            const float weight = (dx ? fx[l] : 1.0f - fx[l]) * (dy ? fy[l] : 1.0f - fy[l]);
            red[l] = fma(weight, vload_half(texel, texels), red[l]);
            green[l] = fma(weight, vload_half(texel + 1ul, texels), green[l]);
            blue[l] = fma(weight, vload_half(texel + 2ul, texels), blue[l]);
        }
        share[l] = rt_sky_share(ctx->sky_picks, (uint)w, (uint)h, (uint)min(max(cell_row[l], 0), h - 1), (uint)min(max(cell_column[l], 0), w - 1));
    }
    *density = rt_sky_density_of_place(rt_load(share), sine);
    /* The texel's light first: the product of two factors may be less than a float holds. */
    return rt_mul(rt_spread(sky->sky_color), rt_scale(rt_vfloat(sky->sky_scale), rt_vec_of(rt_load(red), rt_load(green), rt_load(blue))));
}

/* The number of the last of sums[0 .. count] that is at most `number`, of those before the last. */
RT_INLINE uint rt_sky_find(const global uint *sums, uint count, uint number)
{
    uint first = 0, end = count;
    while (end - first > 1u) {
        const uint middle = (first + end) / 2u;
        if (sums[middle] <= number)
            first = middle;
        else
            end = middle;
    }
    return first;
}

/* Draws a place within what running sums deal to: 0 .. count. */
RT_INLINE float rt_sky_draw_place(const global uint *sums, uint count, float u, uint *cell)
{
    const float number = min(u * (float)RT_PICKS, (float)(RT_PICKS - 1));
    *cell = rt_sky_find(sums, count, (uint)number);
    return (float)*cell + (number - (float)sums[*cell]) / (float)max(sums[*cell + 1u] - sums[*cell], 1u);
}

RT_INLINE rt_vec rt_draw_sky_picture(const rt_ctx *ctx, vfloat u1, vfloat u2)
{
    const global rt_lighting *sky = ctx->lighting;
    const uint w = sky->sky_width, h = sky->sky_height;
    float across[RT_LANES], down[RT_LANES];
    rt_store(u1, across);
    rt_store(u2, down);
    for (uint l = 0; l < RT_LANES; ++l) {
        uint row, column;
        down[l] = rt_sky_draw_place(ctx->sky_picks, h, down[l], &row);
        across[l] = rt_sky_draw_place(ctx->sky_picks + (h + 1u) + row * (w + 1u), w, across[l], &column);
    }
    const vfloat turns = rt_load(across) * rt_vfloat(1.0f / (float)w) - rt_vfloat(0.5f + sky->sky_turn);
    vfloat sine, cosine, sine_up, cosine_up;
    rt_sin_cos_turns(turns, &sine, &cosine);
    rt_sin_cos_turns(rt_load(down) * rt_vfloat(0.5f / (float)h), &sine_up, &cosine_up);
    return rt_vec_of(sine_up * cosine, cosine_up, sine_up * sine);
}
#endif

/* How much brighter than their mean, zenith and horizon together, a gradient is at an elevation above the horizon, of which y is the sine. */
RT_INLINE vfloat rt_gradient_shape(const global rt_lighting *sky, vfloat y)
{
    const float horizon = sky->sky_horizon_share;
    return rt_vfloat(2.0f) * fma(y, rt_vfloat(1.0f - 2.0f * horizon), rt_vfloat(horizon));
}

/* The density with which directions to a gradient are drawn. Below the horizon it is even. */
RT_INLINE vfloat rt_gradient_density(const global rt_lighting *sky, vfloat y)
{
    const float below = (float)sky->sky_below * (1.0f / RT_PICKS);
    return rt_vfloat(0.5f * RT_INVERSE_PI) *
           rt_select(RT_MASK(y < rt_vfloat(0.0f)), rt_vfloat(below), rt_vfloat(1.0f - below) * rt_gradient_shape(sky, y));
}

RT_INLINE rt_vec rt_draw_gradient(const global rt_lighting *sky, vfloat u1, vfloat u2)
{
    const vfloat one = rt_vfloat(1.0f), number = rt_min(u1 * rt_vfloat((float)RT_PICKS), rt_vfloat((float)(RT_PICKS - 1)));
    const vfloat first_above = rt_vfloat((float)sky->sky_below), middle = rt_vfloat(0.5f); /* of the part of [0, 1) that has the number */
    const float horizon = sky->sky_horizon_share;
    const vfloat depth = (number + middle) / rt_max(first_above, one);
    /* The share v of the light above the horizon is below y: 2 horizon y + (1 - 2 horizon) y^2 = v. */
    const vfloat v = (number - first_above + middle) / rt_max(rt_vfloat((float)RT_PICKS) - first_above, one);
    const vfloat root = sqrt(rt_max(fma(v, rt_vfloat(1.0f - 2.0f * horizon), rt_vfloat(horizon * horizon)), rt_vfloat(0.0f)));
    const vfloat height = v / rt_max(rt_vfloat(horizon) + root, rt_vfloat(1e-9f));
    const vfloat y = rt_min(rt_max(rt_select(RT_MASK(number < first_above), -depth, height), -one), one);
    const vfloat radius = sqrt((one - y) * (one + y));
    vfloat sine, cosine;
    rt_sin_cos_turns(u2, &sine, &cosine);
    return rt_vec_of(radius * cosine, y, radius * sine);
}

/* The radiance of the sky in unit directions of the lanes, and the density with which rt_draw_sky() draws them. */
RT_INLINE rt_vec rt_sky_radiance(const rt_ctx *ctx, rt_vec direction, vmask lanes, vfloat *density)
{
    const global rt_lighting *sky = ctx->lighting;
#ifdef RT_HAS_SKY_PICTURE
    if (sky->sky_kind == RT_SKY_PICTURE) return rt_sky_picture(ctx, direction, lanes, density);
#endif
    const rt_vec color = rt_spread(sky->sky_color);
    *density = rt_vfloat(0.25f * RT_INVERSE_PI);
    if (sky->sky_kind == RT_SKY_CONSTANT) return color;
    *density = rt_gradient_density(sky, direction.y);
    const rt_vec horizon = rt_spread(sky->sky_horizon);
    const rt_vec above = rt_along(rt_max(direction.y, rt_vfloat(0.0f)), rt_sub(color, horizon), horizon);
    return rt_choose(RT_MASK(direction.y < rt_vfloat(0.0f)), rt_spread(sky->sky_ground), above);
}

/* Draws unit directions. */
RT_INLINE rt_vec rt_draw_sky(const rt_ctx *ctx, vfloat u1, vfloat u2)
{
#ifdef RT_HAS_SKY_PICTURE
    if (ctx->lighting->sky_kind == RT_SKY_PICTURE) return rt_draw_sky_picture(ctx, u1, u2);
#endif
    if (ctx->lighting->sky_kind == RT_SKY_GRADIENT) return rt_draw_gradient(ctx->lighting, u1, u2);
    return rt_warp_cone(u1, u2, rt_vfloat(2.0f));
}

#endif
