/* material.h -- loads the materials and texture samples of all lanes. */
#ifndef RT_MATERIAL_H
#define RT_MATERIAL_H

/* The material of each lane; the members are those of rt_material. */
typedef struct rt_shade {
    rt_vec color; /* diffuse, texture included */
    rt_vec emission, specular;
    vfloat shininess, reflect, refract, ior;
#ifdef RT_HAS_CUTOUTS
    vfloat coverage; /* the share of the surface that is there */
#endif
} rt_shade;

#if RT_HAS_TEXTURES
/* sRGB to linear, 0..1, of the lowest 8 bits of `byte`. Programs that include sampling/math.h have the exact curve. In others a cubic
 * polynomial differs from it by at most 0.4 % of full scale, and is an order of magnitude cheaper than pow. */
RT_INLINE vfloat rt_linear(vint byte)
{
    const vfloat c = rt_to_float(byte & rt_vint(255)) * rt_vfloat(1.0f / 255.0f);
#ifdef RT_MATH_H
    return rt_srgb_to_linear(c);
#else
    return c * (c * (c * rt_vfloat(0.305306f) + rt_vfloat(0.682171f)) + rt_vfloat(0.012523f));
#endif
}

/* The texel at or before x and the one after it, of `size` texels that repeat. Both are in range whatever x is. */
RT_INLINE void rt_texels(vfloat x, vint size, vint *here, vint *next)
{
    const vint at = min(max(rt_to_int(x), rt_vint(-1)), size - rt_vint(1)), after = at + rt_vint(1);
    *here = rt_select(RT_MASK(at < rt_vint(0)), size - rt_vint(1), at);
    *next = rt_select(RT_MASK(after == size), rt_vint(0), after);
}

#ifdef RT_HAS_WRAPS
#define RT_CLAMPS 1u /* as RT_WRAP_CLAMP and RT_WRAP_MIRROR in rt_plugin.h */
#define RT_MIRRORS 2u
/* Brings a coordinate into 0..1 as a wrap mode says. */
RT_INLINE vfloat rt_wrap(vfloat u, uint mode)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    if (mode == RT_CLAMPS) return rt_min(rt_max(u, zero), one);
    const vfloat within = u - floor(u);
    if (mode != RT_MIRRORS) return within;
    const vfloat half_turns = u * rt_vfloat(0.5f);
    return rt_select(RT_MASK(half_turns - floor(half_turns) < rt_vfloat(0.5f)), within, one - within);
}

/* As rt_texels(), of texels that a wrap mode continues: beyond the border of a picture that is clamped or mirrored is the border. */
RT_INLINE void rt_wrapped_texels(vfloat x, vint size, uint mode, vint *here, vint *next)
{
    if (mode != RT_CLAMPS && mode != RT_MIRRORS) {
        rt_texels(x, size, here, next);
        return;
    }
    const vint at = min(max(rt_to_int(x), rt_vint(-1)), size - rt_vint(1));
    *here = max(at, rt_vint(0));
    *next = min(at + rt_vint(1), size - rt_vint(1));
}
#endif

/* The four RGBA8 texels of texture `index` at (u, v) in each of `lanes`, and their weights: bilinear, and outside of its picture as
 * its wrap modes say. */
RT_INLINE void rt_load_texels(const rt_ctx *ctx, uint index, vmask lanes, vfloat u, vfloat v, vint *color, vfloat *weight)
{
    const rt_texture texture = ctx->textures[index];
    const global uint *texels = ctx->texels + texture.first;
    const vint w = rt_vint((int)texture.width), h = rt_vint((int)texture.height);
    const vfloat one = rt_vfloat(1.0f), middle = rt_vfloat(0.5f);
#ifdef RT_HAS_WRAPS
    const uint mode_u = texture.wrap % RT_WRAP_ALONG_V, mode_v = texture.wrap / RT_WRAP_ALONG_V;
    const vfloat s = rt_wrap(u, mode_u), t = rt_wrap(v, mode_v);
#else
    const vfloat s = u - floor(u), t = v - floor(v);
#endif
    const vfloat x = s * rt_to_float(w) - middle, y = (one - t) * rt_to_float(h) - middle;
    const vfloat left = floor(x), above = floor(y), fx = x - left, fy = y - above;
    vint x0, x1, y0, y1;
#ifdef RT_HAS_WRAPS
    rt_wrapped_texels(left, w, mode_u, &x0, &x1);
    rt_wrapped_texels(above, h, mode_v, &y0, &y1);
#else
    rt_texels(left, w, &x0, &x1);
    rt_texels(above, h, &y0, &y1);
#endif
    for (int k = 0; k < 4; ++k) {
        int texel[RT_LANES];
        rt_store(rt_select(lanes, (k & 2 ? y1 : y0) * w + (k & 1 ? x1 : x0), rt_vint(0)), texel);
        for (uint l = 0; l < RT_LANES; ++l) texel[l] = (int)texels[texel[l]];
        color[k] = rt_load(texel);
        weight[k] = (k & 1 ? fx : one - fx) * (k & 2 ? fy : one - fy);
    }
}

/* Samples a texture's colour. Its texels are converted from sRGB to linear RGB. */
RT_INLINE rt_vec rt_sample_texture(const rt_ctx *ctx, uint index, vmask lanes, vfloat u, vfloat v)
{
    vint color[4];
    vfloat weight[4];
    rt_load_texels(ctx, index, lanes, u, v, color, weight);
    rt_vec sum = rt_splat(0.0f, 0.0f, 0.0f);
    for (int k = 0; k < 4; ++k) {
        sum.x += weight[k] * rt_linear(color[k]);
        sum.y += weight[k] * rt_linear(color[k] >> rt_vint(8));
        sum.z += weight[k] * rt_linear(color[k] >> rt_vint(16));
    }
    return sum;
}

#ifdef RT_HAS_CUTOUTS
/* Samples a texture's alpha, which is linear. */
RT_INLINE vfloat rt_sample_alpha(const rt_ctx *ctx, uint index, vmask lanes, vfloat u, vfloat v)
{
    vint color[4];
    vfloat weight[4], sum = rt_vfloat(0.0f);
    rt_load_texels(ctx, index, lanes, u, v, color, weight);
    for (int k = 0; k < 4; ++k) sum += weight[k] * rt_to_float((color[k] >> rt_vint(24)) & rt_vint(255));
    return sum * rt_vfloat(1.0f / 255.0f);
}
#endif
#endif

/* The color of one material in the lanes `mine`, with its checkerboard and texture and the colours of vertices. */
RT_INLINE rt_vec rt_material_color(const rt_ctx *ctx, const global rt_material *m, const rt_surface *s, vmask mine, rt_vec at)
{
    rt_vec color = rt_spread(m->color);
    if (m->flags & RT_MATERIAL_CHECKER) {
        const vint cell = rt_to_int(floor(at.x)) + rt_to_int(floor(at.z));
        const vfloat dim = rt_select(RT_MASK((cell & rt_vint(1)) != rt_vint(0)), rt_vfloat(1.0f / 3.0f), rt_vfloat(1.0f));
        color = rt_scale(dim, color);
    }
#if RT_HAS_TEXTURES
    if (m->texture != RT_NONE) color = rt_mul(color, rt_sample_texture(ctx, m->texture, mine, s->tex_u, s->tex_v));
#endif
#ifdef RT_HAS_COLORS
    color = rt_mul(color, s->color);
#endif
    return color;
}

#ifdef RT_HAS_CUTOUTS
/* The share of a surface of material m that is there. */
RT_INLINE vfloat rt_coverage_of(const rt_ctx *ctx, const global rt_material *m, const rt_surface *s, vmask lanes)
{
    vfloat alpha = rt_vfloat(m->opacity);
#ifdef RT_HAS_COLORS
    alpha *= s->alpha;
#endif
#if RT_HAS_TEXTURES
    if (m->texture != RT_NONE) alpha *= rt_sample_alpha(ctx, m->texture, lanes, s->tex_u, s->tex_v);
#endif
    alpha = rt_min(alpha, rt_vfloat(1.0f)); /* weights of corners and texels add up to 1 but for rounding */
    if (m->alpha == RT_ALPHA_MASK) alpha = rt_select(RT_MASK(alpha < rt_vfloat(m->cutoff)), rt_vfloat(0.0f), rt_vfloat(1.0f));
    return alpha;
}

/* The share of the surface that is there, of the lanes in `bits`; 1 in others. */
RT_INLINE vfloat rt_coverage(const rt_ctx *ctx, const rt_surface *s, uint bits)
{
    vfloat out = rt_vfloat(1.0f);
    int id;
    vmask mine;
    for (rt_groups g = rt_group_lanes(s->material, bits); rt_next_group(&g, &id, &mine);) {
        const global rt_material *m = ctx->materials + id;
        if (m->alpha != RT_ALPHA_OPAQUE) out = rt_select(mine, rt_coverage_of(ctx, m, s, mine), out);
    }
    return out;
}
#endif

/* Returns the materials of the lanes in `bits`. Lanes that have the same material are handled together. at: the hit points,
 * world; the checkerboard needs them. */
RT_INLINE rt_shade rt_load_materials(const rt_ctx *ctx, const rt_surface *s, uint bits, rt_vec at)
{
    rt_shade out;
    out.color = out.emission = out.specular = rt_splat(0.0f, 0.0f, 0.0f);
    out.reflect = out.refract = rt_vfloat(0.0f);
    out.shininess = out.ior = rt_vfloat(1.0f);
#ifdef RT_HAS_CUTOUTS
    out.coverage = rt_coverage(ctx, s, bits);
#endif
    int id;
    vmask mine;
    for (rt_groups g = rt_group_lanes(s->material, bits); rt_next_group(&g, &id, &mine);) {
        const global rt_material *m = ctx->materials + id;
        out.color = rt_choose(mine, rt_material_color(ctx, m, s, mine, at), out.color);
        out.emission = rt_choose(mine, rt_spread(m->emission), out.emission);
        out.specular = rt_choose(mine, rt_spread(m->specular), out.specular);
        out.shininess = rt_select(mine, rt_vfloat(m->shininess), out.shininess);
        out.reflect = rt_select(mine, rt_vfloat(m->reflect), out.reflect);
        out.refract = rt_select(mine, rt_vfloat(m->refract), out.refract);
        out.ior = rt_select(mine, rt_vfloat(m->ior), out.ior);
    }
    return out;
}

/* The light that a surface sends back. diffuse: incoming light, cosines included. shine: incoming light times highlight. */
RT_INLINE rt_vec rt_reflected_light(const rt_shade *m, rt_vec diffuse, rt_vec shine)
{
    const vfloat share = rt_max(rt_vfloat(1.0f) - m->reflect - m->refract, rt_vfloat(0.0f));
    return rt_add(rt_scale(share, rt_mul(m->color, diffuse)), rt_mul(m->specular, shine));
}

#endif
