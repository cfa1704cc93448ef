/* first_surfaces.h -- the diffuse share of Whitted's mixture as a surface that paths meet. */
#ifndef RT_FIRST_SURFACES_H
#define RT_FIRST_SURFACES_H

typedef struct rt_bsdf {
    rt_vec color;
} rt_bsdf;

typedef struct rt_bsdf_sample {
    rt_vec wi, weight;
    vfloat pdf;
    vmask valid, delta, transmitted;
} rt_bsdf_sample;

RT_INLINE rt_bsdf rt_bsdf_of(const rt_ctx *ctx, const rt_surface *s, vmask entering, uint bits, rt_vec at)
{
    const rt_shade m = rt_load_materials(ctx, s, bits, at);
    rt_bsdf b;
    b.color = rt_scale(rt_max(rt_vfloat(1.0f) - m.reflect - m.refract, rt_vfloat(0.0f)), m.color);
    return b;
}

RT_INLINE rt_vec rt_bsdf_eval(const rt_bsdf *b, rt_vec wo, rt_vec wi, vmask lanes, vfloat *pdf)
{
    *pdf = rt_max(wi.z, rt_vfloat(0.0f)) * rt_vfloat(0.31830989f);
    return rt_scale(*pdf, b->color);
}

RT_INLINE vmask rt_is_glossy(const rt_bsdf *b) { return rt_vint(0); }

RT_INLINE rt_bsdf_sample rt_bsdf_draw(const rt_bsdf *b, rt_vec wo, vfloat u_lobe, vfloat u1, vfloat u2, vmask lanes)
{
    rt_bsdf_sample s;
    rt_warp_disc(u1, u2, &s.wi.x, &s.wi.y);
    s.wi.z = sqrt(rt_max(rt_vfloat(1.0f) - fma(s.wi.x, s.wi.x, s.wi.y * s.wi.y), rt_vfloat(0.0f)));
    s.pdf = s.wi.z * rt_vfloat(0.31830989f);
    s.weight = b->color;
    s.valid = lanes & RT_MASK(s.pdf > rt_vfloat(0.0f));
    s.delta = s.transmitted = rt_vint(0);
    return s;
}

#endif
