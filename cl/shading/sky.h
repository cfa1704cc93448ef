/* sky.h -- the light that comes from beyond the scene: constant, a gradient, or a picture. */
#ifndef RT_SKY_H
#define RT_SKY_H

/* The radiance of the sky in unit directions, and the density with which rt_draw_sky() draws them. */
RT_INLINE rt_vec rt_sky_radiance(const rt_ctx *ctx, rt_vec direction, vmask lanes, vfloat *density)
{
    const global rt_lighting *sky = ctx->lighting;
    *density = rt_vfloat(0.07957747f); /* 1 / (4 pi) */
    const rt_vec color = rt_spread(sky->sky_color);
    if (sky->sky_kind == RT_SKY_CONSTANT) return color;
    const rt_vec horizon = rt_spread(sky->sky_horizon);
    const rt_vec above = rt_along(rt_max(direction.y, rt_vfloat(0.0f)), rt_sub(color, horizon), horizon);
    return rt_choose(RT_MASK(direction.y < rt_vfloat(0.0f)), rt_spread(sky->sky_ground), above);
}

/* Draws directions of the lanes. */
RT_INLINE rt_vec rt_draw_sky(const rt_ctx *ctx, vfloat u1, vfloat u2, vmask lanes)
{
    return rt_warp_cone(u1, u2, rt_vfloat(2.0f));
}

#endif
