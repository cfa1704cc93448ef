/* material.h -- loads the materials of all lanes. */
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
#ifdef RT_HAS_MAPS
    vfloat occlusion; /* the share of ambient light that arrives */
#endif
} rt_shade;

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
    if (m->texture != RT_NONE) {
        const rt_texture_point point = rt_plain_point(ctx, m->texture, s);
        color = rt_mul(color, RT_REFLECTANCE(m->model, rt_sample_texture(ctx, m->texture, mine, &point)));
    }
#endif
#ifdef RT_HAS_MAPS
    color = rt_mul(color, RT_REFLECTANCE(m->model, rt_sample_map(ctx, rt_map_of(ctx, m, RT_MAP_COLOR), s, mine)));
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
    if (m->texture != RT_NONE) {
        const rt_texture_point point = rt_sharp_point(s->tex_u, s->tex_v); /* a mean of alpha would be below the cutoff too often */
        alpha *= rt_sample_channel(ctx, m->texture, lanes, &point, 3);
    }
#endif
#ifdef RT_HAS_MAPS
    alpha *= rt_sharp_map_channel(ctx, rt_map_of(ctx, m, RT_MAP_COLOR), s, lanes, 3);
    alpha *= rt_sharp_map_channel(ctx, rt_map_of(ctx, m, RT_MAP_OPACITY), s, lanes, 0);
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

/* The light that one material emits in the lanes `mine`. */
RT_INLINE rt_vec rt_material_emission(const rt_ctx *ctx, const global rt_material *m, const rt_surface *s, vmask mine)
{
#ifdef RT_HAS_MAPS
    return rt_mul(rt_spread(m->emission), rt_sample_map(ctx, rt_map_of(ctx, m, RT_MAP_EMISSION), s, mine));
#else
    return rt_spread(m->emission);
#endif
}

/* The same without blur, as drawn points of a light have it: two strategies must speak of the same light. */
RT_INLINE rt_vec rt_sharp_emission(const rt_ctx *ctx, const global rt_material *m, const rt_surface *s, vmask mine)
{
    rt_vec emission = rt_spread(m->emission);
#ifdef RT_HAS_MAPS
    const global rt_map *map = rt_map_of(ctx, m, RT_MAP_EMISSION);
    if (map) {
        const rt_texture_point point = rt_sharp_map_point(map, s);
        emission = rt_mul(emission, rt_sample_texture(ctx, map->texture, mine, &point));
    }
#endif
    return emission;
}

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
#ifdef RT_HAS_MAPS
    out.occlusion = rt_vfloat(1.0f);
#endif
    int id;
    vmask mine;
    for (rt_groups g = rt_group_lanes(s->material, bits); rt_next_group(&g, &id, &mine);) {
        const global rt_material *m = ctx->materials + id;
#ifdef RT_HAS_MAPS
        out.occlusion = rt_select(mine, rt_occlusion(ctx, m, s, mine), out.occlusion);
#endif
        out.color = rt_choose(mine, rt_material_color(ctx, m, s, mine, at), out.color);
        out.emission = rt_choose(mine, rt_material_emission(ctx, m, s, mine), out.emission);
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
