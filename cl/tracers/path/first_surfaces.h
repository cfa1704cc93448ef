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

/* By the square of Shirley and Chiu 1997, A Low Distortion Map Between Disk and Square, with polynomials for sine and cosine
 * within an eighth of a turn. */
RT_INLINE rt_bsdf_sample rt_bsdf_draw(const rt_bsdf *b, rt_vec wo, vfloat u_lobe, vfloat u1, vfloat u2, vmask lanes)
{
    const vfloat one = rt_vfloat(1.0f), x = fma(rt_vfloat(2.0f), u1, -one), y = fma(rt_vfloat(2.0f), u2, -one);
    const vmask wide = RT_MASK(fabs(x) > fabs(y));
    const vfloat radius = rt_select(wide, x, y), other = rt_select(wide, y, x);
    const vfloat angle = rt_vfloat(0.78539816f) * other / rt_select(RT_MASK(radius == rt_vfloat(0.0f)), one, radius), q = angle * angle;
    const vfloat sine = angle * fma(q, fma(q, fma(q, rt_vfloat(-1.0f / 5040.0f), rt_vfloat(1.0f / 120.0f)), rt_vfloat(-1.0f / 6.0f)), one);
    const vfloat cosine = fma(q, fma(q, fma(q, rt_vfloat(-1.0f / 720.0f), rt_vfloat(1.0f / 24.0f)), rt_vfloat(-0.5f)), one);
    rt_bsdf_sample s;
    s.wi = rt_vec_of(radius * rt_select(wide, cosine, sine), radius * rt_select(wide, sine, cosine), sqrt(rt_max(fma(-radius, radius, one), rt_vfloat(0.0f))));
    s.pdf = s.wi.z * rt_vfloat(0.31830989f);
    s.weight = b->color;
    s.valid = lanes & RT_MASK(s.pdf > rt_vfloat(0.0f));
    s.delta = s.transmitted = rt_vint(0);
    return s;
}

#endif
