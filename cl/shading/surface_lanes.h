/* surface_lanes.h -- calls the surfaces of plugins for one lane after the other, in programs that have any. The host writes
 * rt_surface_eval_by() and rt_surface_sample_by(), which choose by the model. */
#if defined(RT_SURFACE_PLUGINS) && !defined(RT_SURFACE_LANES_H)
#define RT_SURFACE_LANES_H
#define RT_SURFACE_LANE(value, l) (((const float *)&(value))[l])
#define RT_SURFACE_LANES(v, l) (float3)(RT_SURFACE_LANE((v).x, l), RT_SURFACE_LANE((v).y, l), RT_SURFACE_LANE((v).z, l))

/* Sets f |cos wi| and the density of wi in the lanes with a model of a plugin. Other lanes keep what they have. materials: the number
 * of each lane's material. */
RT_PART void rt_eval_plugins(const rt_ctx *ctx, vint materials, rt_vec color, rt_vec wo, rt_vec wi, vmask lanes, rt_vec *f, vfloat *pdf)
{
    int ids[RT_LANES];
    float r[RT_LANES], g[RT_LANES], b[RT_LANES], density[RT_LANES];
    rt_store(materials, ids);
    rt_store(f->x, r);
    rt_store(f->y, g);
    rt_store(f->z, b);
    rt_store(*pdf, density);
    for (uint bits = rt_bits(lanes); bits != 0u; bits &= bits - 1u) {
        const uint l = rt_lowest(bits), model = ctx->materials[ids[l]].model;
        if (model < RT_MODEL_KINDS) continue;
        const float3 out = RT_SURFACE_LANES(wo, l), in = RT_SURFACE_LANES(wi, l);
        float3 value = (float3)(0.0f);
        density[l] = 0.0f;
        if (out.z > 0.0f && in.z > 0.0f)
            value = in.z * rt_surface_eval_by(model, (const global float *)(ctx->layers + ids[l]), RT_SURFACE_LANES(color, l), out, in, density + l);
        r[l] = value.x, g[l] = value.y, b[l] = value.z;
    }
    *f = rt_vec_of(rt_load(r), rt_load(g), rt_load(b));
    *pdf = rt_load(density);
}

/* Draws a direction in the lanes with a model of a plugin. Other lanes keep what they have. */
RT_PART rt_bsdf_sample rt_draw_plugins(const rt_ctx *ctx, vint materials, rt_vec color, rt_vec wo, rt_numbers n, vmask lanes, rt_bsdf_sample s)
{
    int ids[RT_LANES];
    float x[RT_LANES], y[RT_LANES], z[RT_LANES], r[RT_LANES], g[RT_LANES], b[RT_LANES], density[RT_LANES];
    uint mine = 0, valid = 0;
    rt_store(materials, ids);
    rt_store(s.wi.x, x);
    rt_store(s.wi.y, y);
    rt_store(s.wi.z, z);
    rt_store(s.weight.x, r);
    rt_store(s.weight.y, g);
    rt_store(s.weight.z, b);
    rt_store(s.pdf, density);
    for (uint bits = rt_bits(lanes); bits != 0u; bits &= bits - 1u) {
        const uint l = rt_lowest(bits), model = ctx->materials[ids[l]].model;
        if (model < RT_MODEL_KINDS) continue;
        mine |= 1u << l;
        const float3 out = RT_SURFACE_LANES(wo, l);
        if (!(out.z > 0.0f)) continue;
        const float3 u = (float3)(RT_SURFACE_LANE(n.a, l), RT_SURFACE_LANE(n.b, l), RT_SURFACE_LANE(n.c, l));
        const rt_surface_draw draw = rt_surface_sample_by(model, (const global float *)(ctx->layers + ids[l]), RT_SURFACE_LANES(color, l), out, u);
        if (!(draw.pdf > 0.0f && draw.wi.z > 0.0f)) continue;
        valid |= 1u << l;
        x[l] = draw.wi.x, y[l] = draw.wi.y, z[l] = draw.wi.z;
        r[l] = draw.weight.x, g[l] = draw.weight.y, b[l] = draw.weight.z;
        density[l] = draw.pdf;
    }
    const vmask plugged = rt_mask_of_bits(mine);
    s.wi = rt_vec_of(rt_load(x), rt_load(y), rt_load(z));
    s.weight = rt_vec_of(rt_load(r), rt_load(g), rt_load(b));
    s.pdf = rt_load(density);
    s.valid = (s.valid & ~plugged) | rt_mask_of_bits(valid);
    s.delta &= ~plugged;
    s.transmitted &= ~plugged;
    return s;
}

#endif
