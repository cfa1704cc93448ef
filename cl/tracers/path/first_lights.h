/* first_lights.h -- point and directional lights, background and the emission of surfaces, as paths find them. */
#ifndef RT_FIRST_LIGHTS_H
#define RT_FIRST_LIGHTS_H

typedef struct rt_light_sample {
    rt_vec towards;
    vfloat distance;
    rt_vec radiance_over_pdf;
    vfloat pdf;
    vmask valid, delta;
    vint light;
} rt_light_sample;

RT_INLINE rt_light_sample rt_light_draw(const rt_ctx *ctx, const constant rt_frame *frame, rt_vec at, vfloat u_pick, vfloat u1, vfloat u2,
                                        vmask lanes)
{
    const uint count = frame->light_count;
    const vfloat one = rt_vfloat(1.0f);
    rt_light_sample s;
    s.towards = rt_splat(0.0f, 0.0f, 1.0f);
    s.distance = RT_INFINITY;
    s.radiance_over_pdf = rt_splat(0.0f, 0.0f, 0.0f);
    s.pdf = one;
    s.valid = s.delta = rt_vint(0);
    s.light = min(rt_to_int(u_pick * rt_vfloat((float)count)), rt_vint((int)count - 1));
    for (uint i = 0; i < count; ++i) {
        const vmask mine = lanes & RT_MASK(s.light == rt_vint((int)i));
        if (!rt_any(mine)) continue;
        const global rt_light *light = ctx->lights + i;
        if (light->kind != RT_LIGHT_POINT && light->kind != RT_LIGHT_DIRECTIONAL) continue;
        const bool is_point = light->kind == RT_LIGHT_POINT, falls = (light->flags & RT_LIGHT_FALLOFF) != 0u;
        rt_vec towards = rt_spread(light->position);
        vfloat scale = one;
        if (is_point) {
            towards = rt_sub(towards, at);
            scale = rt_inverse_length(towards);
            towards = rt_scale(scale, towards);
            s.distance = rt_select(mine, one / scale, s.distance);
        }
        const vfloat strength = falls ? (is_point ? scale * scale : one) : rt_vfloat(3.14159265f);
        s.towards = rt_choose(mine, towards, s.towards);
        s.radiance_over_pdf = rt_choose(mine, rt_scale(strength * rt_vfloat((float)count), rt_spread(light->color)), s.radiance_over_pdf);
        s.valid |= mine;
        s.delta |= mine;
    }
    return s;
}

#define RT_LIGHT_OF_SURFACES 0x40000000
#define RT_LIGHT_OF_SKY 0x40000001

RT_INLINE void rt_hit_lights(const rt_ctx *ctx, const constant rt_frame *frame, const rt_rays *ray, vfloat *t, vint *light)
{
    *light = rt_vint(-1);
}

RT_INLINE rt_vec rt_emission_of_light(const rt_ctx *ctx, const rt_rays *ray, vfloat t, vint light, vmask lanes, vfloat *pdf)
{
    *pdf = rt_vfloat(0.0f);
    return rt_splat(0.0f, 0.0f, 0.0f);
}

RT_INLINE rt_vec rt_emission_of_hit(const rt_ctx *ctx, const rt_rays *ray, const rt_hits *hit, const rt_surface *surface, vmask lanes, vfloat *pdf)
{
    *pdf = rt_vfloat(0.0f);
    rt_vec sum = rt_splat(0.0f, 0.0f, 0.0f);
    int numbers[RT_LANES];
    rt_store(surface->material, numbers);
    for (uint left = rt_bits(lanes); left != 0u;) {
        const int id = numbers[rt_lowest(left)];
        const vmask mine = RT_MASK(surface->material == rt_vint(id));
        left &= ~rt_bits(mine);
        sum = rt_choose(mine, rt_spread(ctx->materials[id].emission), sum);
    }
    return sum;
}

RT_INLINE rt_vec rt_sky(const rt_ctx *ctx, const constant rt_frame *frame, rt_vec direction, vmask lanes, vfloat *pdf)
{
    *pdf = rt_vfloat(0.0f);
    return rt_splat(frame->background[0], frame->background[1], frame->background[2]);
}

RT_INLINE rt_vec rt_seen_sky(const rt_ctx *ctx, const constant rt_frame *frame, rt_vec direction, vmask lanes)
{
    vfloat pdf;
    return rt_sky(ctx, frame, direction, lanes, &pdf);
}

RT_INLINE bool rt_has_emitters(const rt_ctx *ctx, const constant rt_frame *frame) { return frame->light_count != 0u; }

#endif
