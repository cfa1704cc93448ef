/* matter_maps.h -- what the maps of a material say of RT_MODEL_GLTF. Channels: glTF 2.0, section 3.9, and its extensions' pages. */
#ifndef RT_MATTER_MAPS_H
#define RT_MATTER_MAPS_H
#if defined(RT_HAS_MAPS) && RT_MAY_SCATTER(RT_LOBE_LAYERS)

/* Multiplies the lanes `mine` of *value by a channel of a map. */
RT_INLINE void rt_multiply(const rt_ctx *ctx, const global rt_map *map, const rt_surface *s, vmask mine, int channel, vfloat *value)
{
    if (map) *value = rt_select(mine, *value * rt_sample_map_channel(ctx, map, s, mine, channel), *value);
}
RT_INLINE void rt_multiply_color(const rt_ctx *ctx, const global rt_map *map, const rt_surface *s, vmask mine, rt_vec *value)
{
    if (map) *value = rt_choose(mine, rt_mul(*value, RT_REFLECTANCE(RT_MODEL_GLTF, rt_sample_map(ctx, map, s, mine))), *value);
}

#if RT_MAY_SCATTER(RT_LOBE_COAT)
RT_INLINE void rt_map_coat(const rt_ctx *ctx, const global rt_material *material, const rt_surface *s, vmask mine, vfloat *coat, vfloat *roughness)
{
    rt_multiply(ctx, rt_map_of(ctx, material, RT_MAP_CLEARCOAT), s, mine, 0, coat);
    rt_multiply(ctx, rt_map_of(ctx, material, RT_MAP_CLEARCOAT_ROUGHNESS), s, mine, 1, roughness);
}
#endif

/* Multiplies the matter of material `id` in the lanes `mine` by its maps. That of the colour is in it already. */
RT_INLINE void rt_map_matter(const rt_ctx *ctx, int id, const rt_surface *s, vmask mine, rt_matter *m)
{
    const global rt_material *material = ctx->materials + id;
#define RT_MAP(use) rt_map_of(ctx, material, use)
    const global rt_map *both = RT_MAP(RT_MAP_METALLIC_ROUGHNESS), *rough = RT_MAP(RT_MAP_ROUGHNESS), *metal = RT_MAP(RT_MAP_METALLIC);
    rt_multiply(ctx, rough ? rough : both, s, mine, rough ? 0 : 1, &m->roughness);
    rt_multiply(ctx, metal ? metal : both, s, mine, metal ? 0 : 2, &m->metallic);
    rt_multiply(ctx, RT_MAP(RT_MAP_TRANSMISSION), s, mine, 0, &m->transmission);
    rt_multiply(ctx, RT_MAP(RT_MAP_SPECULAR), s, mine, 3, &m->specular_weight);
    rt_multiply_color(ctx, RT_MAP(RT_MAP_SPECULAR_COLOR), s, mine, &m->specular_color);
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    rt_map_coat(ctx, material, s, mine, &m->clearcoat, &m->clearcoat_roughness);
#ifdef RT_HAS_TANGENTS
    /* Without a map of its own the varnish is smooth, whatever is below. */
    const global rt_map *coat = RT_MAP(RT_MAP_CLEARCOAT_NORMAL);
    rt_vec mapped = rt_splat(0.0f, 0.0f, 1.0f), tangent, bitangent;
    if (coat) mapped = rt_mapped_normal(ctx, coat, s, mine);
    const rt_vec placed = rt_normalize(rt_along(mapped.x, s->tangent, rt_along(mapped.y, s->bitangent, rt_scale(mapped.z, s->unmapped))));
    rt_basis(s->normal, &tangent, &bitangent);
    rt_turn_frame(s, s->normal, &tangent, &bitangent);
    m->coat_normal = rt_choose(mine, rt_to_local(tangent, bitangent, s->normal, placed), m->coat_normal);
#endif
#endif
#if RT_MAY_SCATTER(RT_LOBE_SHEEN)
    rt_multiply_color(ctx, RT_MAP(RT_MAP_SHEEN_COLOR), s, mine, &m->sheen_color);
    rt_multiply(ctx, RT_MAP(RT_MAP_SHEEN_ROUGHNESS), s, mine, 3, &m->sheen_roughness);
#endif
#if RT_MAY_SCATTER(RT_LOBE_GRAIN)
    const global rt_map *grain = RT_MAP(RT_MAP_ANISOTROPY);
    if (grain) {
        const vfloat one = rt_vfloat(1.0f), least = rt_vfloat(1e-12f);
        rt_vec mapped = rt_vec_of(one, rt_vfloat(0.0f), fma(rt_vfloat(2.0f), rt_sample_map_channel(ctx, grain, s, mine, 2), -one));
#ifdef RT_HAS_TANGENTS
        mapped = rt_mapped_normal(ctx, grain, s, mine);
#endif
        const vfloat length2 = fma(mapped.x, mapped.x, mapped.y * mapped.y), scale = one / sqrt(rt_max(length2, least));
        const vfloat x = rt_select(RT_MASK(length2 > least), scale * mapped.x, one), y = scale * mapped.y;
        const vfloat turned_x = fma(x, m->grain_x, -(y * m->grain_y)), turned_y = fma(x, m->grain_y, y * m->grain_x);
        m->anisotropy = rt_select(mine, m->anisotropy * fma(rt_vfloat(0.5f), mapped.z, rt_vfloat(0.5f)), m->anisotropy);
        m->grain_x = rt_select(mine, turned_x, m->grain_x);
        m->grain_y = rt_select(mine, turned_y, m->grain_y);
    }
#endif
#if RT_MAY_SCATTER(RT_LOBE_FILM)
    rt_multiply(ctx, RT_MAP(RT_MAP_IRIDESCENCE), s, mine, 0, &m->iridescence);
    const global rt_map *film = RT_MAP(RT_MAP_IRIDESCENCE_THICKNESS);
    if (film) {
        const vfloat least = rt_vfloat(ctx->layers[id].iridescence_thickness_min);
        const vfloat share = rt_sample_map_channel(ctx, film, s, mine, 1);
        m->iridescence_thickness = rt_select(mine, fma(share, m->iridescence_thickness - least, least), m->iridescence_thickness);
    }
#endif
#undef RT_MAP
}

#endif
#endif
