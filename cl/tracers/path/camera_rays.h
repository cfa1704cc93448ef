/* camera_rays.h -- the camera rays of paths: each through a point of its own of its pixel, and of the lens. */
#ifndef RT_PATH_CAMERA_RAYS_H
#define RT_PATH_CAMERA_RAYS_H

/* From a number in 0..1 to a place in -1.5..1.5, distributed by a Gaussian with deviation 0.5: our fit of the inverse of its
 * integral, within 0.0015. */
RT_INLINE vfloat rt_gaussian_place(vfloat u)
{
    const vfloat t = fma(u, rt_vfloat(2.0f), rt_vfloat(-1.0f)), q = t * t;
    const vfloat above = fma(q, fma(q, fma(q, rt_vfloat(-0.14938022f), rt_vfloat(0.85872812f)), rt_vfloat(-1.3337433f)), rt_vfloat(0.62533284f));
    const vfloat below = fma(q, fma(q, fma(q, rt_vfloat(-0.44266894f), rt_vfloat(1.8312041f)), rt_vfloat(-2.3879092f)), rt_vfloat(1.0f));
    return t * above / below;
}

/* n: the numbers of the camera's set. The filter of pixels is what the points are distributed by, so all count alike: Ernst,
 * Stamminger, Greiner 2006, Filter Importance Sampling. Thin lens: Cook, Porter, Carpenter 1984, Distributed Ray Tracing. */
RT_INLINE void rt_path_camera_rays(const constant rt_frame *frame, vint x, vint y, const rt_numbers *n, rt_rays *r)
{
    const bool gaussian = (frame->path_flags & RT_PATH_GAUSSIAN) != 0u;
    const vfloat middle = rt_vfloat(0.5f);
    const vfloat px = gaussian ? rt_gaussian_place(n->a) + middle : n->a, py = gaussian ? rt_gaussian_place(n->b) + middle : n->b;
    rt_camera_rays_through(frame, rt_to_float(x) + px, rt_to_float(y) + py, r);
    if (frame->lens_y == 0.0f) return;
    vfloat across, up;
    rt_warp_disc(n->c, n->d, &across, &up);
    const rt_vec forward = rt_spread_constant(frame->forward), direction = rt_vec_of(r->dx, r->dy, r->dz);
    const rt_vec sharp = rt_scale(rt_vfloat(frame->focus) / rt_dot(direction, forward), direction); /* from the lens' middle */
    const rt_vec shift = rt_along(across * frame->lens_x, rt_spread_constant(frame->right), rt_scale(up * frame->lens_y, rt_spread_constant(frame->up)));
    const rt_vec bent = rt_normalize(rt_sub(sharp, shift));
    r->ox += shift.x, r->oy += shift.y, r->oz += shift.z;
    r->dx = bent.x, r->dy = bent.y, r->dz = bent.z;
}

#endif
