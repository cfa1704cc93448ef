/* surface_lanes.h -- calls the surfaces of plugins for one lane after the other, in programs that have any. The host writes
 * rt_surface_eval_by() and rt_surface_sample_by(), which choose by the model. */
#if defined(RT_SURFACE_PLUGINS) && !defined(RT_SURFACE_LANES_H)
#define RT_SURFACE_LANES_H

/* A vector of each lane, in memory. */
typedef struct rt_vec_lanes {
    float x[RT_LANES], y[RT_LANES], z[RT_LANES];
} rt_vec_lanes;

RT_INLINE rt_vec_lanes rt_lanes_of(rt_vec v)
{
    rt_vec_lanes lanes;
    rt_store(v.x, lanes.x);
    rt_store(v.y, lanes.y);
    rt_store(v.z, lanes.z);
    return lanes;
}
RT_INLINE rt_vec rt_vec_of_lanes(const rt_vec_lanes *lanes) { return rt_vec_of(rt_load(lanes->x), rt_load(lanes->y), rt_load(lanes->z)); }
RT_INLINE float3 rt_vec_at(const rt_vec_lanes *lanes, uint l) { return (float3)(lanes->x[l], lanes->y[l], lanes->z[l]); }
RT_INLINE void rt_set_vec_at(rt_vec_lanes *lanes, uint l, float3 v)
{
    lanes->x[l] = v.x;
    lanes->y[l] = v.y;
    lanes->z[l] = v.z;
}

/* Sets f |cos wi| and the density of wi in the lanes with a model of a plugin. Other lanes keep what they have. materials: the number
 * of each lane's material. */
RT_PART void rt_eval_plugins(const rt_ctx *ctx, vint materials, rt_vec color, rt_vec wo, rt_vec wi, vmask lanes, rt_vec *f, vfloat *pdf)
{
    int ids[RT_LANES];
    float density[RT_LANES];
    const rt_vec_lanes colors = rt_lanes_of(color), outs = rt_lanes_of(wo), ins = rt_lanes_of(wi);
    rt_vec_lanes found = rt_lanes_of(*f);
    rt_store(materials, ids);
    rt_store(*pdf, density);
    for (uint bits = rt_bits(lanes); bits != 0u; bits &= bits - 1u) {
        const uint l = rt_lowest(bits), model = ctx->materials[ids[l]].model;
        if (model < RT_MODEL_KINDS) continue;
        const float3 out = rt_vec_at(&outs, l), in = rt_vec_at(&ins, l);
        float3 value = (float3)(0.0f);
        density[l] = 0.0f;
        if (out.z > 0.0f && in.z > 0.0f)
            value = in.z * rt_surface_eval_by(model, (const global float *)(ctx->layers + ids[l]), rt_vec_at(&colors, l), out, in, density + l);
        rt_set_vec_at(&found, l, value);
    }
    *f = rt_vec_of_lanes(&found);
    *pdf = rt_load(density);
}

/* Draws a direction in the lanes with a model of a plugin. Other lanes keep what they have. */
RT_PART rt_bsdf_sample rt_draw_plugins(const rt_ctx *ctx, vint materials, rt_vec color, rt_vec wo, rt_numbers n, vmask lanes, rt_bsdf_sample s)
{
    int ids[RT_LANES];
    float density[RT_LANES], u[3][RT_LANES];
    uint mine = 0, valid = 0;
    const rt_vec_lanes colors = rt_lanes_of(color), outs = rt_lanes_of(wo);
    rt_vec_lanes ins = rt_lanes_of(s.wi), weights = rt_lanes_of(s.weight);
    rt_store(materials, ids);
    rt_store(n.a, u[0]);
    rt_store(n.b, u[1]);
    rt_store(n.c, u[2]);
    rt_store(s.pdf, density);
    for (uint bits = rt_bits(lanes); bits != 0u; bits &= bits - 1u) {
        const uint l = rt_lowest(bits), model = ctx->materials[ids[l]].model;
        if (model < RT_MODEL_KINDS) continue;
        mine |= 1u << l;
        const float3 out = rt_vec_at(&outs, l);
        if (!(out.z > 0.0f)) continue;
        const rt_surface_draw draw = rt_surface_sample_by(model, (const global float *)(ctx->layers + ids[l]), rt_vec_at(&colors, l), out,
                                                          (float3)(u[0][l], u[1][l], u[2][l]));
        if (!(draw.pdf > 0.0f && draw.wi.z > 0.0f)) continue;
        valid |= 1u << l;
        rt_set_vec_at(&ins, l, draw.wi);
        rt_set_vec_at(&weights, l, draw.weight);
        density[l] = draw.pdf;
    }
    const vmask plugged = rt_mask_of_bits(mine);
    s.wi = rt_vec_of_lanes(&ins);
    s.weight = rt_vec_of_lanes(&weights);
    s.pdf = rt_load(density);
    s.valid = (s.valid & ~plugged) | rt_mask_of_bits(valid);
    s.delta &= ~plugged;
    s.transmitted &= ~plugged;
    return s;
}

#endif
