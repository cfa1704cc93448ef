/* surface_lanes.h -- calls the surfaces of plugins for one lane after the other, in programs that have any. The host writes
 * rt_surface_eval_by() and rt_surface_sample_by(), which choose by the model. */
#if defined(RT_SURFACE_PLUGINS) && !defined(RT_SURFACE_LANES_H)
#define RT_SURFACE_LANES_H

/* Sets f |cos wi| and the density of wi in the lanes with a model of a plugin. Other lanes keep what they have. materials: the number
 * of each lane's material. */
RT_PART void rt_eval_plugins(const rt_ctx *ctx, vint materials, rt_vec color, rt_vec wo, rt_vec wi, vmask lanes, rt_vec *f, vfloat *pdf)
{
    int ids[RT_LANES];
    float density[RT_LANES];
    float4 colors[RT_LANES], outs[RT_LANES], ins[RT_LANES], found[RT_LANES];
    rt_store_lanes(color, 0.0f, colors);
    rt_store_lanes(wo, 0.0f, outs);
    rt_store_lanes(wi, 0.0f, ins);
    rt_store_lanes(*f, 0.0f, found);
    rt_store(materials, ids);
    rt_store(*pdf, density);
    for (uint bits = rt_bits(lanes); bits != 0u; bits &= bits - 1u) {
        const uint l = rt_lowest(bits), model = ctx->materials[ids[l]].model;
        if (model < RT_MODEL_KINDS) continue;
        const float3 out = outs[l].xyz, in = ins[l].xyz;
        float3 value = (float3)(0.0f);
        density[l] = 0.0f;
        if (out.z > 0.0f && in.z > 0.0f)
            value = in.z * rt_surface_eval_by(model, (const global float *)(ctx->layers + ids[l]), colors[l].xyz, out, in, density + l);
        found[l].xyz = value;
    }
    *f = rt_load_lanes(found);
    *pdf = rt_load(density);
}

/* Draws a direction in the lanes with a model of a plugin. Other lanes keep what they have. */
RT_PART rt_bsdf_sample rt_draw_plugins(const rt_ctx *ctx, vint materials, rt_vec color, rt_vec wo, rt_numbers n, vmask lanes, rt_bsdf_sample s)
{
    int ids[RT_LANES];
    float density[RT_LANES];
    uint mine = 0, valid = 0;
    float4 colors[RT_LANES], outs[RT_LANES], ins[RT_LANES], weights[RT_LANES], u[RT_LANES];
    rt_store_lanes(color, 0.0f, colors);
    rt_store_lanes(wo, 0.0f, outs);
    rt_store_lanes(s.wi, 0.0f, ins);
    rt_store_lanes(s.weight, 0.0f, weights);
    rt_store(materials, ids);
    rt_store_lanes(rt_vec_of(n.a, n.b, n.c), 0.0f, u);
    rt_store(s.pdf, density);
    for (uint bits = rt_bits(lanes); bits != 0u; bits &= bits - 1u) {
        const uint l = rt_lowest(bits), model = ctx->materials[ids[l]].model;
        if (model < RT_MODEL_KINDS) continue;
        mine |= 1u << l;
        const float3 out = outs[l].xyz;
        if (!(out.z > 0.0f)) continue;
        const rt_surface_draw draw = rt_surface_sample_by(model, (const global float *)(ctx->layers + ids[l]), colors[l].xyz, out, u[l].xyz);
        if (!(draw.pdf > 0.0f && draw.wi.z > 0.0f)) continue;
        valid |= 1u << l;
        ins[l].xyz = draw.wi;
        weights[l].xyz = draw.weight;
        density[l] = draw.pdf;
    }
    const vmask plugged = rt_mask_of_bits(mine);
    s.wi = rt_load_lanes(ins);
    s.weight = rt_load_lanes(weights);
    s.pdf = rt_load(density);
    s.valid = (s.valid & ~plugged) | rt_mask_of_bits(valid);
    s.delta &= ~plugged;
    s.transmitted &= ~plugged;
    return s;
}

#endif
