/* material.h -- materials and textures of all lanes. */
#ifndef RT_MATERIAL_H
#define RT_MATERIAL_H

typedef struct rt_shade {
    rt_vec color; /* diffuse, texture included */
    rt_vec emission, specular;
    vfloat shininess, reflect, refract, ior;
} rt_shade;

#if RT_HAS_TEXTURES
/* Bilinear, repeating. RGBA8 sRGB to linear; four reads and weights. */
RT_INLINE float3 rt_sample_texture(const rt_ctx *ctx, uint index, float u, float v)
{
    const rt_texture texture = ctx->textures[index];
    const float x = (u - floor(u)) * (float)texture.width - 0.5f;
    const float y = (1.0f - (v - floor(v))) * (float)texture.height - 0.5f;
    const float fx = x - floor(x), fy = y - floor(y);
    const int w = (int)texture.width, h = (int)texture.height;
    const int x0 = ((int)floor(x) + w) % w, y0 = ((int)floor(y) + h) % h;
    const int x1 = x0 + 1 == w ? 0 : x0 + 1, y1 = y0 + 1 == h ? 0 : y0 + 1;
    float3 sum = (float3)(0.0f);
    for (int k = 0; k < 4; ++k) {
        const uint texel = ctx->texels[texture.first + (uint)((k & 2 ? y1 : y0) * w + (k & 1 ? x1 : x0))];
        const float weight = (k & 1 ? fx : 1.0f - fx) * (k & 2 ? fy : 1.0f - fy);
        const float3 color = (float3)((float)(texel & 255u), (float)(texel >> 8 & 255u), (float)(texel >> 16 & 255u)) * (1.0f / 255.0f);
        /* A cubic within 0.4 % of full scale of the sRGB curve, an order cheaper than pow. */
        sum += weight * color * (color * (color * 0.305306f + 0.682171f) + 0.012523f);
    }
    return sum;
}
#endif

/* Fills in the material of each lane; lanes that share one are served together. at: the hit points. */
RT_INLINE rt_shade rt_load_materials(const rt_ctx *ctx, const rt_surface *s, uint bits, rt_vec at)
{
    rt_shade out;
    out.color = out.emission = out.specular = rt_splat(0.0f, 0.0f, 0.0f);
    out.reflect = out.refract = rt_vfloat(0.0f);
    out.shininess = out.ior = rt_vfloat(1.0f);
    int material[RT_LANES];
    rt_store(s->material, material);
    uint left = bits;
    while (left != 0u) {
        const int id = material[rt_lowest(left)];
        const vmask mine = RT_MASK(s->material == rt_vint(id));
        left &= ~rt_bits(mine);
        const global rt_material *m = ctx->materials + id;
        rt_vec color = rt_spread(m->color);
        if (m->flags & RT_MATERIAL_CHECKER) {
            const vint cell = rt_to_int(floor(at.x)) + rt_to_int(floor(at.z));
            const vfloat dim = rt_select(RT_MASK((cell & rt_vint(1)) != rt_vint(0)), rt_vfloat(1.0f / 3.0f), rt_vfloat(1.0f));
            color = rt_scale(dim, color);
        }
#if RT_HAS_TEXTURES
        if (m->texture != RT_NONE) {
            float tu[RT_LANES], tv[RT_LANES], tr[RT_LANES], tg[RT_LANES], tb[RT_LANES];
            const uint mine_bits = rt_bits(mine) & bits;
            rt_store(s->tex_u, tu);
            rt_store(s->tex_v, tv);
            for (uint l = 0; l < RT_LANES; ++l) {
                float3 c = (float3)(1.0f);
                if (mine_bits >> l & 1u) c = rt_sample_texture(ctx, m->texture, tu[l], tv[l]);
                tr[l] = c.x;
                tg[l] = c.y;
                tb[l] = c.z;
            }
            color = rt_mul(color, rt_vec_of(rt_load(tr), rt_load(tg), rt_load(tb)));
        }
#endif
        out.color = rt_choose(mine, color, out.color);
        out.emission = rt_choose(mine, rt_spread(m->emission), out.emission);
        out.specular = rt_choose(mine, rt_spread(m->specular), out.specular);
        out.shininess = rt_select(mine, rt_vfloat(m->shininess), out.shininess);
        out.reflect = rt_select(mine, rt_vfloat(m->reflect), out.reflect);
        out.refract = rt_select(mine, rt_vfloat(m->refract), out.refract);
        out.ior = rt_select(mine, rt_vfloat(m->ior), out.ior);
    }
    return out;
}

/* What a surface sends back of the light that it gets: diffuse, cosines included, and the light of its highlights. */
RT_INLINE rt_vec rt_reflected_light(const rt_shade *m, rt_vec diffuse, rt_vec shine)
{
    const vfloat share = rt_max(rt_vfloat(1.0f) - m->reflect - m->refract, rt_vfloat(0.0f));
    return rt_add(rt_scale(share, rt_mul(m->color, diffuse)), rt_mul(m->specular, shine));
}

/* x^y for x in [0,1], y >= 1, as exp2(y log2 x) by polynomials: 1e-3 relative at y = 100. Plain arithmetic, so that all lane
 * counts and devices agree, where a library's pow would differ. */
RT_INLINE vfloat rt_power(vfloat x, vfloat y)
{
    const vint xi = rt_as_vint(rt_max(x, rt_vfloat(1e-20f)));
    const vint e = (xi >> 23) - 127;
    const vfloat m = rt_as_vfloat((xi & 0x007fffff) | 0x3f800000); /* 1..2 */
    /* log2(m) = 2/ln2 (z + z^3/3 + z^5/5 + ..), z = (m-1)/(m+1) <= 1/3 */
    const vfloat z = (m - 1.0f) / (m + 1.0f), z2 = z * z;
    vfloat series = rt_vfloat(0.32059889f);
    series = fma(series, z2, rt_vfloat(0.41219858f));
    series = fma(series, z2, rt_vfloat(0.57707802f));
    series = fma(series, z2, rt_vfloat(0.96179669f));
    series = fma(series, z2, rt_vfloat(2.8853901f));
    const vfloat l = rt_max(y * fma(z, series, rt_to_float(e)), rt_vfloat(-126.0f));
    const vfloat whole = floor(l), f = l - whole;
    vfloat power = rt_vfloat(0.0013333558f); /* 2^f by its Taylor series, f in 0..1 */
    power = fma(power, f, rt_vfloat(0.0096181291f));
    power = fma(power, f, rt_vfloat(0.055504109f));
    power = fma(power, f, rt_vfloat(0.24022651f));
    power = fma(power, f, rt_vfloat(0.69314718f));
    power = fma(power, f, rt_vfloat(1.0f));
    return power * rt_as_vfloat((rt_to_int(whole) + 127) << 23);
}

#endif
