/* camera_rays.h -- the camera rays of paths: each through a point of its own of its pixel. */
#ifndef RT_PATH_CAMERA_RAYS_H
#define RT_PATH_CAMERA_RAYS_H

/* n: the numbers of the camera's set. */
RT_INLINE void rt_path_camera_rays(const constant rt_frame *frame, vint x, vint y, const rt_numbers *n, rt_rays *r)
{
    rt_camera_rays_through(frame, rt_to_float(x) + n->a, rt_to_float(y) + n->b, r);
}

#endif
