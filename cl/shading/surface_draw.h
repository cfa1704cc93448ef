/* surface_draw.h -- what <id>_sample of a surface's plugin returns (rt_surface.h). */
#ifndef RT_SURFACE_DRAW_H
#define RT_SURFACE_DRAW_H

typedef struct rt_surface_draw {
    float3 wi;     /* in the frame of the shading normal */
    float3 weight; /* f cos / pdf */
    float pdf;     /* 0: nothing is drawn, and the path ends */
} rt_surface_draw;

#endif
