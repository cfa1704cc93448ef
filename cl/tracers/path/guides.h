/* guides.h -- what the denoiser (cl/denoise.cl) has to know of a pixel besides its light: what its camera rays meet first. Only programs
 * with RT_GUIDES have it.
 *
 * They are sums over the samples of the pixel, in more planes of the film, from RT_PLANE_OWN on:
 *   OWN     light that comes to the camera without scattering (emission, lamps, the sky), and 1 / depth
 *   ALBEDO  by which the denoiser divides the rest of the light
 *   NORMAL  on the side of the camera; reversed where the surface does not scatter diffusely, so that mirrors and walls differ
 * What scatters no light adds 0 to all but the first three. The depth is along the camera's axis: its inverse changes linearly over a
 * plane in the picture. */
#ifndef RT_PATH_GUIDES_H
#define RT_PATH_GUIDES_H
#ifdef RT_GUIDES

/* One number for each colour by which textures are divided out; it need not be exact, as the same one multiplies again. */
RT_INLINE rt_vec rt_guide_albedo(const rt_bsdf *b)
{
    const vfloat colored = b->diffuse + b->metal, white = b->mirror + b->glass;
    rt_vec albedo = rt_add(rt_scale(colored, b->color), rt_vec_of(white, white, white));
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
    albedo = rt_choose(b->layered.lanes, rt_along(rt_vfloat(1.0f) - b->glass, b->color, rt_vec_of(b->glass, b->glass, b->glass)), albedo);
#endif
    return albedo;
}

/* Adds to the planes of the lanes that are at the first event of a path. p->light: what they have met so far. */
RT_PART void rt_add_guides(const constant rt_frame *frame, const rt_path *p, vmask lanes, vfloat inverse_depth, rt_vec albedo, rt_vec normal)
{
    const uint bits = rt_bits(lanes & RT_MASK(p->event == rt_vint(0)));
    if (bits == 0u) return;
    const size_t pixels = (size_t)frame->width * frame->height;
    float4 of_lanes[RT_FILM_PLANES - RT_PLANE_OWN][RT_LANES];
    float depths[RT_LANES];
    int pixel[RT_LANES], sample[RT_LANES];
    rt_store_lanes(p->light, 0.0f, of_lanes[0]);
    rt_store_lanes(albedo, 0.0f, of_lanes[RT_PLANE_ALBEDO - RT_PLANE_OWN]);
    rt_store_lanes(normal, 0.0f, of_lanes[RT_PLANE_NORMAL - RT_PLANE_OWN]);
    rt_store(inverse_depth, depths);
    rt_store(p->pixel, pixel);
    rt_store(p->sample, sample);
    for (uint l = 0; l < RT_LANES; ++l) {
        if ((bits >> l & 1u) == 0u) continue;
        of_lanes[0][l].w = depths[l];
        const bool is_first = frame->adds == 0u && sample[l] == (int)frame->sample;
        global float4 *at = p->guides + rt_film_place(frame, (uint)pixel[l]);
        for (uint plane = 0; plane < RT_FILM_PLANES - RT_PLANE_OWN; ++plane, at += pixels) *at = is_first ? of_lanes[plane][l] : *at + of_lanes[plane][l];
    }
}

/* Rays that meet no surface, or one that ends their paths. */
RT_INLINE void rt_guide_end(const constant rt_frame *frame, const rt_path *p, vmask lanes)
{
    const rt_vec none = rt_splat(0.0f, 0.0f, 0.0f);
    rt_add_guides(frame, p, lanes, rt_vfloat(0.0f), none, none);
}

/* Rays that meet surfaces, at a distance of t, which scatter light. */
RT_INLINE void rt_guide_surface(const constant rt_frame *frame, const rt_path *p, vmask lanes, vfloat t, rt_vec normal, const rt_bsdf *bsdf)
{
    const vfloat along = rt_dot(p->direction, rt_spread_constant(frame->forward)), one = rt_vfloat(1.0f);
    rt_add_guides(frame, p, lanes, one / rt_max(t * along, rt_vfloat(1e-30f)), rt_guide_albedo(bsdf),
                  rt_scale(rt_select(rt_is_diffuse(bsdf), one, -one), normal));
}

#endif
#endif
