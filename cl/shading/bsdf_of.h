/* bsdf_of.h -- loads the surfaces of all lanes for the path tracer. */
#ifndef RT_BSDF_OF_H
#define RT_BSDF_OF_H

/* The surfaces of the lanes in `bits`. entering: the ray comes from the side that the normal points to. around: ior on that side. at: the
 * points, world. */
RT_INLINE rt_bsdf rt_bsdf_of(const rt_ctx *ctx, const rt_surface *s, vmask entering, vfloat around, uint bits, rt_vec at)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    rt_bsdf out;
    out.color = rt_splat(0.0f, 0.0f, 0.0f);
    out.diffuse = out.mirror = out.metal = out.glass = out.alpha = zero;
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
        out.alpha = rt_select(mine, rt_vfloat(alpha > 0.0f ? max(alpha, RT_LEAST_ALPHA) : 0.0f), out.alpha);
        const vfloat ior = rt_vfloat(m->ior);
        out.eta = rt_select(mine, rt_select(entering, ior / around, around / ior), out.eta);
        if (m->flags & RT_MATERIAL_SINGLE_SCATTER) out.compensate &= ~mine;
    }
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
    out.color = rt_choose(layered, matter.color, out.color);
    out.diffuse = rt_select(layered, one - matter.metallic, out.diffuse);
    out.metal = rt_select(layered, matter.metallic, out.metal);
    out.alpha = rt_select(layered, rt_max(matter.roughness * matter.roughness, rt_vfloat(RT_LEAST_ALPHA)), out.alpha);
#endif
#if RT_MAY_SCATTER(RT_LOBE_FROSTED)
    /* Where nothing is refracted, facets have no effect, and their normals cannot be told from directions. */
    const vmask straight = RT_MASK(rt_max(out.eta, one / out.eta) < rt_vfloat(1.001f));
    out.alpha = rt_select(RT_MASK(out.glass > zero) & straight, zero, out.alpha);
#endif
    return out;
}

#endif
