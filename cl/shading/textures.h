/* textures.h -- samples textures in all lanes. */
#ifndef RT_TEXTURES_H
#define RT_TEXTURES_H
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

/* A point of a texture in each lane. */
typedef struct rt_texture_point {
    vfloat u, v;
#ifdef RT_HAS_MIPS
    vfloat level; /* of the smaller pictures; 0: the picture itself */
#endif
} rt_texture_point;

#ifdef RT_MIX_MIPS
#define RT_TAPS 8 /* four texels of a picture, and four of the next smaller one */
#else
#define RT_TAPS 4
#endif
/* Texels (RGBA8, or of bright textures) and their weights. The weights add up to 1. */
typedef struct rt_taps {
    vint color[RT_TAPS];
    vfloat weight[RT_TAPS];
} rt_taps;

/* Loads four texels of the pictures of w x h texels that begin `offset` texels behind the texture's first. s, t: within 0..1. share:
 * by which their weights are multiplied. */
RT_INLINE void rt_load_four(const rt_ctx *ctx, const rt_texture *texture, vmask lanes, vint w, vint h, vint offset, vfloat s, vfloat t,
                            vfloat share, vint *color, vfloat *weight)
{
    const global uint *texels = ctx->texels + texture->first;
    const vfloat one = rt_vfloat(1.0f), middle = rt_vfloat(0.5f);
    vfloat x = s * rt_to_float(w) - middle, y = (one - t) * rt_to_float(h) - middle;
    if (texture->flags & RT_TEXTURE_NEAREST) x = floor(x + middle), y = floor(y + middle);
    const vfloat left = floor(x), above = floor(y), fx = x - left, fy = y - above;
    vint x0, x1, y0, y1;
#ifdef RT_HAS_WRAPS
    rt_wrapped_texels(left, w, texture->wrap % RT_WRAP_ALONG_V, &x0, &x1);
    rt_wrapped_texels(above, h, texture->wrap / RT_WRAP_ALONG_V, &y0, &y1);
#else
    rt_texels(left, w, &x0, &x1);
    rt_texels(above, h, &y0, &y1);
#endif
    for (int k = 0; k < 4; ++k) {
        int texel[RT_LANES];
        rt_store(rt_select(lanes, offset + (k & 2 ? y1 : y0) * w + (k & 1 ? x1 : x0), rt_vint(0)), texel);
        for (uint l = 0; l < RT_LANES; ++l) texel[l] = (int)texels[texel[l]];
        color[k] = rt_load(texel);
        weight[k] = share * ((k & 1 ? fx : one - fx) * (k & 2 ? fy : one - fy));
    }
}

#ifdef RT_HAS_MIPS
/* log2 of numbers above 0, to 0.09: straight between powers of two. */
RT_INLINE vfloat rt_rough_log2(vfloat x)
{
    return rt_to_float(rt_as_vint(x)) * rt_vfloat(1.0f / 8388608.0f) - rt_vfloat(127.0f);
}

/* Width, height and place of the picture at a level of a texture in each lane. */
RT_INLINE void rt_level_size(const rt_ctx *ctx, const rt_texture *texture, vint level, vmask lanes, vint *w, vint *h, vint *offset)
{
    int at[RT_LANES], width[RT_LANES], height[RT_LANES], first[RT_LANES];
    rt_store(rt_select(lanes, level, rt_vint(0)), at);
    for (uint l = 0; l < RT_LANES; ++l) {
        width[l] = (int)texture->width, height[l] = (int)texture->height, first[l] = 0;
        if (at[l] == 0) continue;
        const global rt_texture *smaller = ctx->textures + texture->smaller + (uint)at[l] - 1u;
        width[l] = (int)smaller->width, height[l] = (int)smaller->height, first[l] = (int)(smaller->first - texture->first);
    }
    *w = rt_load(width);
    *h = rt_load(height);
    *offset = rt_load(first);
}
#endif

/* Loads the texels around a point in each of `lanes`, with their bilinear weights. They are those of the picture of the nearest level, or
 * with RT_MIX_MIPS of the two nearest. Outside of the picture its wrap modes count. */
RT_INLINE rt_taps rt_load_texels(const rt_ctx *ctx, const rt_texture *texture, vmask lanes, const rt_texture_point *p)
{
#ifdef RT_HAS_WRAPS
    const vfloat s = rt_wrap(p->u, texture->wrap % RT_WRAP_ALONG_V), t = rt_wrap(p->v, texture->wrap / RT_WRAP_ALONG_V);
#else
    const vfloat s = p->u - floor(p->u), t = p->v - floor(p->v);
#endif
    const vfloat one = rt_vfloat(1.0f);
    rt_taps taps;
    vint w = rt_vint((int)texture->width), h = rt_vint((int)texture->height), offset = rt_vint(0);
#ifdef RT_MIX_MIPS
    const vfloat zero = rt_vfloat(0.0f), last = rt_vfloat((float)texture->levels);
    const vfloat level = rt_min(rt_max(p->level, zero), last), lower = floor(level), share = level - lower;
    if (rt_any(lanes & RT_MASK(level > zero))) rt_level_size(ctx, texture, rt_to_int(lower), lanes, &w, &h, &offset);
    rt_load_four(ctx, texture, lanes, w, h, offset, s, t, one - share, taps.color, taps.weight);
    if (rt_any(lanes & RT_MASK(share > zero))) {
        rt_level_size(ctx, texture, rt_to_int(rt_min(lower + one, last)), lanes, &w, &h, &offset);
        rt_load_four(ctx, texture, lanes, w, h, offset, s, t, share, taps.color + 4, taps.weight + 4);
    } else {
        for (int k = 4; k < 8; ++k) taps.color[k] = rt_vint(0), taps.weight[k] = zero;
    }
#else
#ifdef RT_HAS_MIPS
    const vint level = min(rt_to_int(rt_max(p->level, rt_vfloat(0.0f)) + rt_vfloat(0.5f)), rt_vint((int)texture->levels));
    if (rt_any(lanes & RT_MASK(level > rt_vint(0)))) rt_level_size(ctx, texture, level, lanes, &w, &h, &offset);
#endif
    rt_load_four(ctx, texture, lanes, w, h, offset, s, t, one, taps.color, taps.weight);
#endif
    return taps;
}

/* A channel of texels as it is stored, 0..1. channel: 0 to 3. */
RT_INLINE vfloat rt_channel(const rt_taps *taps, int channel)
{
    vfloat sum = rt_vfloat(0.0f);
    for (int k = 0; k < RT_TAPS; ++k) sum += taps->weight[k] * rt_to_float((taps->color[k] >> rt_vint(8 * channel)) & rt_vint(255));
    return sum * rt_vfloat(1.0f / 255.0f);
}

#ifdef RT_HAS_BRIGHT_TEXTURES
#define RT_BRIGHT 4u /* a flag of rt_texture: as kBrightTexture in host/scene/bright_texture.hpp */
/* The same of a bright texture: numbers of 9 bits, and their exponent in the highest 5, times a power of two: bits 8 to 15 of the
 * texture's flags. It has no alpha. */
RT_INLINE vfloat rt_bright_channel(const rt_taps *taps, uint flags, int channel)
{
    const int power = (int)(flags << 16) >> 24;
    vfloat sum = rt_vfloat(0.0f);
    if (channel == 3) return rt_vfloat(1.0f);
    for (int k = 0; k < RT_TAPS; ++k) {
        const vint texel = taps->color[k], exponent = ((texel >> rt_vint(27)) & rt_vint(31)) + rt_vint(127 - 24);
        sum += taps->weight[k] * rt_as_vfloat(exponent << rt_vint(23)) * rt_to_float((texel >> rt_vint(9 * channel)) & rt_vint(511));
    }
    return sum * rt_vfloat(as_float((power + 127) << 23));
}
#endif

/* Samples a texture's r, g and b, as linear colours if they are sRGB. */
RT_INLINE rt_vec rt_sample_texture(const rt_ctx *ctx, uint index, vmask lanes, const rt_texture_point *p)
{
    const rt_texture texture = ctx->textures[index];
    const rt_taps taps = rt_load_texels(ctx, &texture, lanes, p);
#ifdef RT_HAS_BRIGHT_TEXTURES
    if (texture.flags & RT_BRIGHT)
        return rt_vec_of(rt_bright_channel(&taps, texture.flags, 0), rt_bright_channel(&taps, texture.flags, 1), rt_bright_channel(&taps, texture.flags, 2));
#endif
    if (texture.flags & RT_TEXTURE_LINEAR) return rt_vec_of(rt_channel(&taps, 0), rt_channel(&taps, 1), rt_channel(&taps, 2));
    rt_vec sum = rt_splat(0.0f, 0.0f, 0.0f);
    for (int k = 0; k < RT_TAPS; ++k) {
        sum.x += taps.weight[k] * rt_linear(taps.color[k]);
        sum.y += taps.weight[k] * rt_linear(taps.color[k] >> rt_vint(8));
        sum.z += taps.weight[k] * rt_linear(taps.color[k] >> rt_vint(16));
    }
    return sum;
}

/* What a texture says of a surface that reflects light is at most 1: no surface sends more than it gets. What is unlit shines. */
#ifdef RT_HAS_BRIGHT_TEXTURES
RT_INLINE rt_vec rt_reflectance(uint model, rt_vec color)
{
    const vfloat most = model == RT_MODEL_UNLIT ? RT_INFINITY : rt_vfloat(1.0f);
    return rt_vec_of(rt_min(color.x, most), rt_min(color.y, most), rt_min(color.z, most));
}
#define RT_REFLECTANCE(model, color) rt_reflectance(model, color)
#else
#define RT_REFLECTANCE(model, color) color
#endif

/* Samples one channel of a texture as it is stored, 0..1. Alpha is, always. */
RT_INLINE vfloat rt_sample_channel(const rt_ctx *ctx, uint index, vmask lanes, const rt_texture_point *p, int channel)
{
    const rt_texture texture = ctx->textures[index];
    const rt_taps taps = rt_load_texels(ctx, &texture, lanes, p);
#ifdef RT_HAS_BRIGHT_TEXTURES
    if (texture.flags & RT_BRIGHT) return rt_min(rt_bright_channel(&taps, texture.flags, channel), rt_vfloat(1.0f));
#endif
    return rt_channel(&taps, channel);
}

#endif
#endif
