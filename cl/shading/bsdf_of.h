/* bsdf_of.h -- loads the surfaces of all lanes for the path tracer. */
#ifndef RT_BSDF_OF_H
#define RT_BSDF_OF_H

#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
/* Loads material `id` in the lanes `mine`. at: the points, world. */
RT_INLINE void rt_load_matter(const rt_ctx *ctx, const rt_surface *s, int id, vmask mine, rt_vec at, rt_matter *out)
{
    const global rt_material *m = ctx->materials + id;
    const global rt_layers *l = ctx->layers + id;
    out->color = rt_choose(mine, rt_material_color(ctx, m, s, mine, at), out->color);
    out->specular_color = rt_choose(mine, rt_spread(l->specular_color), out->specular_color);
    out->roughness = rt_select(mine, rt_vfloat(m->roughness), out->roughness);
    out->metallic = rt_select(mine, rt_vfloat(l->metallic), out->metallic);
    out->specular_weight = rt_select(mine, rt_vfloat(l->specular_weight), out->specular_weight);
    out->transmission = rt_select(mine, rt_vfloat(l->transmission), out->transmission);
    out->ior = rt_select(mine, rt_vfloat(m->ior), out->ior);
    if (l->flags & RT_LAYERS_SOLID) out->solid |= mine;
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    out->clearcoat = rt_select(mine, rt_vfloat(l->clearcoat), out->clearcoat);
    out->clearcoat_roughness = rt_select(mine, rt_vfloat(l->clearcoat_roughness), out->clearcoat_roughness);
#endif
#if RT_MAY_SCATTER(RT_LOBE_SHEEN)
    out->sheen_color = rt_choose(mine, rt_spread(l->sheen_color), out->sheen_color);
    out->sheen_roughness = rt_select(mine, rt_vfloat(l->sheen_roughness), out->sheen_roughness);
#endif
#if RT_MAY_SCATTER(RT_LOBE_GRAIN)
    vfloat sine, cosine;
    rt_sin_cos_turns(rt_vfloat(l->anisotropy_rotation * (1.0f / 360.0f)), &sine, &cosine);
    out->anisotropy = rt_select(mine, rt_vfloat(l->anisotropy), out->anisotropy);
    out->grain_x = rt_select(mine, cosine, out->grain_x);
    out->grain_y = rt_select(mine, sine, out->grain_y);
#endif
#if RT_MAY_SCATTER(RT_LOBE_FILM)
    out->iridescence = rt_select(mine, rt_vfloat(l->iridescence), out->iridescence);
    out->iridescence_ior = rt_select(mine, rt_vfloat(l->iridescence_ior), out->iridescence_ior);
    out->iridescence_thickness = rt_select(mine, rt_vfloat(l->iridescence_thickness), out->iridescence_thickness);
#endif
#ifdef RT_HAS_MAPS
    rt_map_matter(ctx, id, s, mine, out);
#endif
}
#endif

/* The surfaces of the lanes in `bits`. entering: the ray comes from the side that the normal points to. around: ior on that side. at: the
 * points, world. */
RT_PART rt_bsdf rt_bsdf_of(const rt_ctx *ctx, const rt_surface *s, vmask entering, vfloat around, uint bits, rt_vec at)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    rt_bsdf out;
    out.color = rt_splat(0.0f, 0.0f, 0.0f);
    out.diffuse = out.mirror = out.metal = out.glass = zero;
    out.facets = rt_even_facets(zero);
    out.eta = one;
    out.compensate = rt_vint(-1);
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
    rt_matter matter = rt_no_matter();
    vmask layered = rt_vint(0);
#endif
    int id;
    vmask mine;
    for (rt_groups g = rt_group_lanes(s->material, bits); rt_next_group(&g, &id, &mine);) {
        const global rt_material *m = ctx->materials + id;
        float diffuse = 0.0f, mirror = 0.0f, metal = 0.0f, glass = 0.0f, alpha = 0.0f;
        if (m->model == RT_MODEL_LAMBERT) {
            diffuse = 1.0f;
        } else if (m->model == RT_MODEL_WHITTED) {
            diffuse = max(1.0f - m->reflect - m->refract, 0.0f);
            mirror = m->reflect;
            glass = m->refract;
        } else if (m->model == RT_MODEL_UNLIT) {
            /* It scatters nothing. */
#ifdef RT_SURFACE_PLUGINS
        } else if (m->model >= RT_MODEL_KINDS) {
            diffuse = 1.0f; /* what asks for no values, as the denoiser's guides, takes it for a diffuse surface */
#endif
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
        } else if (m->model == RT_MODEL_GLTF) {
            rt_load_matter(ctx, s, id, mine, at, &matter);
            layered |= mine;
            continue;
#endif
        } else if (RT_LOBES != 0u) {
            alpha = m->roughness * m->roughness;
            if (m->model == RT_MODEL_CONDUCTOR) metal = 1.0f;
            else glass = 1.0f;
        }
        out.color = rt_choose(mine, rt_material_color(ctx, m, s, mine, at), out.color);
        out.diffuse = rt_select(mine, rt_vfloat(diffuse), out.diffuse);
        if (RT_LOBES == 0u) continue;
        out.mirror = rt_select(mine, rt_vfloat(mirror), out.mirror);
        out.metal = rt_select(mine, rt_vfloat(metal), out.metal);
        out.glass = rt_select(mine, rt_vfloat(glass), out.glass);
        out.facets = rt_choose_facets(mine, rt_even_facets(rt_vfloat(alpha > 0.0f ? max(alpha, RT_LEAST_ALPHA) : 0.0f)), out.facets);
        const vfloat ior = rt_vfloat(m->ior);
        out.eta = rt_select(mine, rt_select(entering, ior / around, around / ior), out.eta);
        if (m->flags & RT_MATERIAL_SINGLE_SCATTER) out.compensate &= ~mine;
    }
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
    out.layered = rt_layered_of(&matter, layered, around);
    const vfloat eta = rt_select(entering, matter.ior / around, around / matter.ior);
    out.color = rt_choose(layered, matter.color, out.color);
    out.glass = rt_select(layered & matter.solid, (one - matter.metallic) * matter.transmission, out.glass);
    out.facets = rt_choose_facets(layered, out.layered.facets, out.facets);
    out.eta = rt_select(layered & matter.solid, eta, out.eta);
#endif
#if RT_MAY_SCATTER(RT_LOBE_FROSTED)
    /* Where nothing is refracted, facets have no effect, and their normals cannot be told from directions. */
    const vmask straight = RT_MASK(rt_max(out.eta, one / out.eta) < rt_vfloat(1.001f));
    out.facets.alpha = rt_select(RT_MASK(out.glass > zero) & straight, zero, out.facets.alpha);
#endif
    return out;
}

#if RT_MAY_SCATTER(RT_LOBE_UNLIT)
/* The lanes in `bits` with RT_MODEL_UNLIT, and what they show. */
RT_INLINE vmask rt_unlit(const rt_ctx *ctx, const rt_surface *s, uint bits, rt_vec at, rt_vec *shown)
{
    vmask unlit = rt_vint(0);
    *shown = rt_splat(0.0f, 0.0f, 0.0f);
    int id;
    vmask mine;
    for (rt_groups g = rt_group_lanes(s->material, bits); rt_next_group(&g, &id, &mine);) {
        const global rt_material *m = ctx->materials + id;
        if (m->model != RT_MODEL_UNLIT) continue;
        unlit |= mine;
        *shown = rt_choose(mine, rt_material_color(ctx, m, s, mine, at), *shown);
    }
    return unlit;
}
#endif

#endif
