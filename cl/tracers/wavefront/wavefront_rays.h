/* wavefront_rays.h -- the queue of deferred rays in global memory: three float4 a ray, 48 B, for any number of lanes.
 *   origin x, y, z, pixel's index in the picture | direction x, y, z, weight red | weight green, blue, number of generations before, rt_rays.travelled
 * The index and the number are ints in the bits of floats. */
#ifndef RT_WAVEFRONT_RAYS_H
#define RT_WAVEFRONT_RAYS_H

#define RT_WAVEFRONT_RAY 3u

/* Loads the rays [first, first + RT_LANES) of `count`. Returns the lanes below `count`; the others get the last ray. */
RT_INLINE vmask rt_load_wavefront_rays(const global float4 *rays, uint first, uint count, rt_rays *ray, rt_vec *weight, vint *pixel,
                                   vint *generation)
{
    float field[9][RT_LANES];
    int number[RT_LANES], age[RT_LANES];
    for (uint l = 0; l < RT_LANES; ++l) {
        const global float4 *in = rays + RT_WAVEFRONT_RAY * (size_t)min(first + l, count - 1u);
        const float4 from = in[0], along = in[1], rest = in[2];
        field[0][l] = from.x, field[1][l] = from.y, field[2][l] = from.z;
        field[3][l] = along.x, field[4][l] = along.y, field[5][l] = along.z;
        field[6][l] = along.w, field[7][l] = rest.x, field[8][l] = rest.y;
        number[l] = as_int(from.w);
        age[l] = as_int(rest.z);
    }
    ray->ox = rt_load(field[0]), ray->oy = rt_load(field[1]), ray->oz = rt_load(field[2]);
    ray->dx = rt_load(field[3]), ray->dy = rt_load(field[4]), ray->dz = rt_load(field[5]);
    ray->t_min = rt_vfloat(0.0f);
    *weight = rt_vec_of(rt_load(field[6]), rt_load(field[7]), rt_load(field[8]));
    *pixel = rt_load(number);
    *generation = rt_load(age);
#ifdef RT_CARRIES_CONES
    for (uint l = 0; l < RT_LANES; ++l) field[0][l] = rays[RT_WAVEFRONT_RAY * (size_t)min(first + l, count - 1u) + 2u].w;
    ray->travelled = rt_load(field[0]);
#endif
    return RT_MASK(rt_lane_index() + rt_vint((int)first) < rt_vint((int)count));
}

/* Stores the rays of the lanes in `bits` one after the other from `first` on, but none at or beyond `room`. next_ray: has come as far. */
RT_INLINE void rt_store_wavefront_rays(global float4 *rays, uint room, uint first, uint bits, const rt_rays *next_ray, rt_vec origin,
                                       rt_vec direction, rt_vec weight, vint pixel, vint generation)
{
    float travelled[RT_LANES] = {0};
#ifdef RT_CARRIES_CONES
    rt_store(next_ray->travelled, travelled);
#endif
    float field[9][RT_LANES];
    int number[RT_LANES], age[RT_LANES];
    rt_store(origin.x, field[0]), rt_store(origin.y, field[1]), rt_store(origin.z, field[2]);
    rt_store(direction.x, field[3]), rt_store(direction.y, field[4]), rt_store(direction.z, field[5]);
    rt_store(weight.x, field[6]), rt_store(weight.y, field[7]), rt_store(weight.z, field[8]);
    rt_store(pixel, number);
    rt_store(generation, age);
    uint at = first;
    for (uint l = 0; l < RT_LANES; ++l) {
        if ((bits >> l & 1u) == 0u || at >= room) continue;
        global float4 *out = rays + RT_WAVEFRONT_RAY * (size_t)at++;
        out[0] = (float4)(field[0][l], field[1][l], field[2][l], as_float(number[l]));
        out[1] = (float4)(field[3][l], field[4][l], field[5][l], field[6][l]);
        out[2] = (float4)(field[7][l], field[8][l], as_float(age[l]), travelled[l]);
    }
}

#endif
