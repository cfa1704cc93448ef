/* state.h -- the paths of a packet: one in each lane, and the next pixel for a lane whose path has ended.
 *
 * A lane keeps its pixel for all samples of a launch, so that their sum has their order. */
#ifndef RT_PATH_STATE_H
#define RT_PATH_STATE_H

/* The most solids within each other of which a path knows that it is inside. Of more it forgets the outermost. */
#define RT_SOLIDS 4

typedef struct rt_path {
    vmask alive;
    vint slot;         /* number of the pixel in the packet, block by block; -1: no pixel is left for this lane */
    vint pixel;        /* in the whole picture */
    vint sample;       /* of the pixel */
    vint event;        /* number of scattering events behind it */
    vint first;        /* RT_FIRST_*, of the first of them; -1: none */
    rt_vec origin, direction;
    rt_vec weight, light;
    vfloat pdf;        /* density per solid angle with which the surface has drawn `direction` */
    RT_BY_TREE(rt_vec normal;) /* of that surface; 0, 0, 0: it is lit from both sides */
    vfloat scale;      /* by which entered glass makes the weight small */
    rt_vec absorption; /* of the medium around the ray, per unit of length */
#if RT_MAY_SCATTER(RT_LOBE_GLASS)
    vint inside[RT_SOLIDS]; /* materials of the solids around the ray, the innermost first; -1: none */
#endif
    vmask sharp;       /* there was no choice: the direction is the camera's, or that of a smooth mirror or glass */
#ifdef RT_SPLITS_INCOHERENT
    vfloat area;       /* rt_surface.area where the ray starts */
#endif
#ifdef RT_HAS_MIPS
    vfloat cone, cone_angle; /* the ray's width where it starts, and how it grows with the distance */
#endif
    RT_RECORD(rt_path_recorder *recorder)
    RT_GUIDE(global float4 *guides) /* planes of the film: guides.h */
} rt_path;

RT_INLINE vmask rt_mask_of_bits(uint bits)
{
#if RT_LANES == 1
    return RT_MASK(bits != 0u);
#else
    return RT_MASK((rt_vint((int)bits) >> rt_lane_index() & rt_vint(1)) != rt_vint(0));
#endif
}

/* Finds the pixel of a slot. Returns whether it is inside packet and picture. */
RT_INLINE bool rt_pixel_of_slot(const constant rt_frame *frame, uint2 origin, uint slot, uint2 *pixel)
{
#if RT_MAX_PIXELS == 1 && RT_LANES == 1
    *pixel = origin;
    return origin.x < frame->width && origin.y < frame->height;
#else
    const uint block = slot / RT_LANES, lane = slot % RT_LANES;
    const uint x = ((block % frame->blocks_x) << frame->block_w_log2) + (lane & (frame->block_w - 1u));
    const uint y = (block / frame->blocks_x) * (RT_LANES >> frame->block_w_log2) + (lane >> frame->block_w_log2);
    *pixel = origin + (uint2)(x, y);
    return x < RT_PACKET_W(frame) && y < RT_PACKET_H(frame) && pixel->x < frame->width && pixel->y < frame->height;
#endif
}

RT_INLINE rt_sampler rt_sampler_of(const constant rt_frame *frame, const rt_path *p)
{
    rt_sampler s;
    s.pixel = p->pixel;
    s.sample = p->sample;
    s.end = frame->sample + frame->samples;
    s.seed = RT_SETTING(frame, seed);
    s.sobol = frame->path_flags & RT_PATH_SOBOL;
    return s;
}

/* The same, and whether the pixel takes samples in this launch (adaptive sampling: sum.h). */
RT_INLINE bool rt_working_pixel_of_slot(const constant rt_frame *frame, const global float4 *film, uint2 origin, uint slot, uint2 *pixel)
{
    if (!rt_pixel_of_slot(frame, origin, slot, pixel)) return false;
    if (frame->adds == 0u || !(RT_SETTING(frame, adaptive) > 0.0f)) return true;
    const uint deviations = as_uint(film[(size_t)(frame->height + pixel->y) * frame->width + pixel->x].w);
    return !(deviations >= 0x80000000u && deviations <= 0xff800000u); /* negative, and -0, but a number */
}

/* A lane begins a new path where its last one has ended. It takes the next sample of its pixel; after the last of them the packet's next
 * pixel, but none that rests. *next: the first slot that no lane has had. film: of the picture; 0 if all slots have been had. */
RT_PART void rt_refill(const constant rt_frame *frame, const global float4 *film, uint2 origin, rt_path *p, uint *next)
{
    const uint slots = RT_BLOCKS(frame) * RT_LANES;
    int slot[RT_LANES], sample[RT_LANES], pixel[RT_LANES], xs[RT_LANES], ys[RT_LANES];
    uint fresh = 0;
    rt_store(p->slot, slot);
    rt_store(p->sample, sample);
    rt_store(p->pixel, pixel);
    const uint dead = ~rt_bits(p->alive) & RT_ALL_LANES;
    for (uint l = 0; l < RT_LANES; ++l) {
        xs[l] = ys[l] = 0;
        if ((dead >> l & 1u) == 0u || slot[l] < 0) continue;
        uint2 at;
        ++sample[l];
        if (sample[l] >= (int)(frame->sample + frame->samples)) {
            sample[l] = (int)frame->sample;
            while (*next < slots && !rt_working_pixel_of_slot(frame, film, origin, *next, &at)) ++*next;
            slot[l] = *next < slots ? (int)(*next)++ : -1;
            if (slot[l] < 0) continue;
        }
        rt_pixel_of_slot(frame, origin, (uint)slot[l], &at);
        at += (uint2)(frame->first_x, frame->first_y);
        xs[l] = (int)at.x;
        ys[l] = (int)at.y;
        pixel[l] = (int)(at.y * frame->whole_width + at.x);
        fresh |= 1u << l;
    }
    p->slot = rt_load(slot);
    if (fresh == 0u) return;
    p->sample = rt_load(sample);
    p->pixel = rt_load(pixel);

    const vmask begun = rt_mask_of_bits(fresh);
    const rt_sampler sampler = rt_sampler_of(frame, p);
    const rt_numbers n = rt_draw_set(&sampler, RT_CAMERA_SET);
    rt_rays ray;
    rt_path_camera_rays(frame, rt_load(xs), rt_load(ys), &n, &ray);
    p->origin = rt_choose(begun, rt_vec_of(ray.ox, ray.oy, ray.oz), p->origin);
    p->direction = rt_choose(begun, rt_vec_of(ray.dx, ray.dy, ray.dz), p->direction);
    p->weight = rt_choose(begun, rt_splat(1.0f, 1.0f, 1.0f), p->weight);
    p->light = rt_choose(begun, rt_splat(0.0f, 0.0f, 0.0f), p->light);
    p->event = rt_select(begun, rt_vint(0), p->event);
    p->first = rt_select(begun, rt_vint(-1), p->first);
    p->pdf = rt_select(begun, rt_vfloat(0.0f), p->pdf);
    p->scale = rt_select(begun, rt_vfloat(1.0f), p->scale);
    p->absorption = rt_choose(begun, rt_splat(0.0f, 0.0f, 0.0f), p->absorption);
#if RT_MAY_SCATTER(RT_LOBE_GLASS)
    for (int k = 0; k < RT_SOLIDS; ++k) p->inside[k] = rt_select(begun, rt_vint(-1), p->inside[k]);
#endif
    p->sharp |= begun;
#ifdef RT_SPLITS_INCOHERENT
    p->area = rt_select(begun, RT_INFINITY, p->area);
#endif
#ifdef RT_HAS_MIPS
    /* Half a pixel: the samples of a pixel lie at different places in it, so their mean is blurred enough. */
    p->cone = rt_select(begun, rt_vfloat(0.0f), p->cone);
    p->cone_angle = rt_select(begun, rt_vfloat(0.5f * rt_pixel_angle(frame)), p->cone_angle);
#endif
    p->alive |= begun;
}

/* All lanes without a path, each as if it had just ended the last sample of a pixel. */
RT_INLINE rt_path rt_no_paths(const constant rt_frame *frame)
{
    rt_path p;
    p.alive = p.sharp = rt_vint(0);
    p.slot = p.pixel = p.event = rt_vint(0);
    p.first = rt_vint(-1);
    p.sample = rt_vint((int)(frame->sample + frame->samples));
    p.origin = p.weight = p.light = p.absorption = rt_splat(0.0f, 0.0f, 0.0f);
    p.direction = rt_splat(0.0f, 0.0f, 1.0f);
    RT_BY_TREE(p.normal = p.origin;)
    p.pdf = rt_vfloat(0.0f);
    p.scale = rt_vfloat(1.0f);
#if RT_MAY_SCATTER(RT_LOBE_GLASS)
    for (int k = 0; k < RT_SOLIDS; ++k) p.inside[k] = rt_vint(-1);
#endif
#ifdef RT_SPLITS_INCOHERENT
    p.area = RT_INFINITY;
#endif
#ifdef RT_HAS_MIPS
    p.cone = p.cone_angle = rt_vfloat(0.0f);
#endif
    return p;
}

/* Whether a number is infinite or none, by its bits: compilers may take isfinite() for granted. */
RT_INLINE bool rt_is_broken(float x) { return (as_uint(x) & 0x7f800000u) == 0x7f800000u; }

/* The place in the film of a pixel of the whole picture. */
RT_INLINE size_t rt_film_place(const constant rt_frame *frame, uint pixel)
{
    const uint y = pixel / frame->whole_width, x = pixel - y * frame->whole_width;
    return (size_t)(y - frame->first_y) * frame->width + (x - frame->first_x);
}

/* Adds the light of paths that have ended to their pixels. *not_finite: counts light that is no number, which is added all the same. */
RT_INLINE void rt_end_paths(const constant rt_frame *frame, const rt_path *p, uint bits, global float4 *film, uint *not_finite)
{
    const size_t pixels = (size_t)frame->width * frame->height;
    float4 light[RT_LANES];
    int pixel[RT_LANES], sample[RT_LANES];
    rt_store_lanes(p->light, 1.0f, light);
    rt_store(p->pixel, pixel);
    rt_store(p->sample, sample);
    for (uint l = 0; l < RT_LANES; ++l)
        if (bits >> l & 1u) {
            rt_add_sample(film, pixels, rt_film_place(frame, (uint)pixel[l]), light[l], frame->adds == 0u && sample[l] == (int)frame->sample);
            *not_finite += rt_is_broken(light[l].x) || rt_is_broken(light[l].y) || rt_is_broken(light[l].z) ? 1u : 0u;
        }
}

#endif
