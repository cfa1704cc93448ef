/* shape.h -- what the kernels of a shape's plugin may use; see "Shapes" in CONTRACT.md. All is in the shape's own space. */
#ifndef RT_SHAPES_H
#define RT_SHAPES_H

/* The rays of all lanes. They start near the shape's box, so that numbers stay small. Directions are not of unit length. */
typedef struct rt_shape_rays {
    rt_vec origin, direction;
    vfloat t_min, t_max; /* the nearest hit counts that is not nearer than t_min; beyond t_max none does */
} rt_shape_rays;

/* The surface at the hits of all lanes. */
typedef struct rt_shape_surface {
    rt_vec normal; /* outward, of any length but 0 */
    vfloat height; /* of the point above the surface, along the normal */
    vfloat error;  /* of `height`, and of the test of a ray that starts there. Set beforehand; a less exact test makes it larger */
    vfloat tex_u, tex_v;
    int wants_uv; /* 0: tex_u and tex_v are not read, and need not be computed */
} rt_shape_surface;

/* The same for plugins with RT_SHAPE_SINGLE_RAY. */
typedef struct rt_shape_ray {
    float3 origin, direction;
    float t_min, t_max;
} rt_shape_ray;
typedef struct rt_shape_point {
    float3 normal;
    float height, error, tex_u, tex_v;
    int wants_uv;
} rt_shape_point;

/* A direction's angle from the x axis to the y axis, in turns, 0 to 1. Lanes are computed one by one, because a library's vector
 * functions need not agree with its scalar ones. */
RT_INLINE vfloat rt_turns(vfloat x, vfloat y)
{
    float xs[RT_LANES], ys[RT_LANES];
    rt_store(x, xs);
    rt_store(y, ys);
    for (uint l = 0; l < RT_LANES; ++l) {
        const float turns = atan2(ys[l], xs[l]) * 0.15915494f;
        xs[l] = turns < 0.0f ? turns + 1.0f : turns;
    }
    return rt_load(xs);
}

/* Two unit vectors across a unit vector (Duff et al. 2017, "Building an Orthonormal Basis, Revisited"). */
RT_INLINE void rt_across(const global float *axis, rt_vec *x, rt_vec *y)
{
    const float sign = axis[2] < 0.0f ? -1.0f : 1.0f, a = -1.0f / (sign + axis[2]), b = axis[0] * axis[1] * a;
    *x = rt_splat(1.0f + sign * axis[0] * axis[0] * a, sign * b, -sign * axis[0]);
    *y = rt_splat(b, sign + axis[1] * axis[1] * a, -axis[1]);
}
#endif
