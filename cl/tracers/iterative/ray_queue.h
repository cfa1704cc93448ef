/* ray_queue.h -- an array of rays in private memory, to which packets are appended: the thesis's `current` and `next`. */
#ifndef RT_RAY_QUEUE_H
#define RT_RAY_QUEUE_H

#define RT_QUEUE_ROOM (RT_MAX_PIXELS * RT_RAY_SLOTS + RT_LANES)

typedef struct rt_queue {
    float field[9][RT_QUEUE_ROOM]; /* origin, direction, weight */
    int pixel[RT_QUEUE_ROOM];      /* within the packet */
#ifdef RT_SPLITS_INCOHERENT
    float area[RT_QUEUE_ROOM];     /* rt_surface.area of the surface that the ray starts on */
#endif
#ifdef RT_CARRIES_CONES
    float travelled[RT_QUEUE_ROOM];
#endif
    RT_RECORD(int record[RT_QUEUE_ROOM])
} rt_queue;

/* rt_compress: moves the lanes in `bits` to the front. */
#if !defined(RT_PORTABLE) && RT_LANES == 16 && defined(__AVX512F__) && RT_HAS_BUILTIN(__builtin_ia32_compresssf512_mask)
#define rt_compress(v, bits) __builtin_ia32_compresssf512_mask(v, (float16)(0.0f), (ushort)(bits))
#elif RT_LANES == 1
#define rt_compress(v, bits) (v)
#else
RT_INLINE vfloat rt_compress(vfloat v, uint bits)
{
    float in[RT_LANES], out[RT_LANES];
    rt_store(v, in);
    rt_store(rt_vfloat(0.0f), out);
    for (uint l = 0, n = 0; l < RT_LANES; ++l)
        if (bits >> l & 1u) out[n++] = in[l];
    return rt_load(out);
}
#endif

RT_INLINE void rt_queue_put(rt_queue *queue, uint field, uint at, vfloat v, uint bits)
{
    rt_store(rt_compress(v, bits), queue->field[field] + at);
}

/* Appends the rays of the lanes in `bits`. Returns the new count. Rays that find no room are dropped and counted. */
RT_INLINE uint rt_append(rt_queue *queue, uint capacity, uint count, uint bits, rt_vec origin, rt_vec direction, rt_vec weight,
                         vint pixel, uint *dropped)
{
    const uint wanted = popcount(bits), taken = min(wanted, capacity - count);
    *dropped += wanted - taken;
    if (taken == 0u) return count;
    rt_queue_put(queue, 0u, count, origin.x, bits);
    rt_queue_put(queue, 1u, count, origin.y, bits);
    rt_queue_put(queue, 2u, count, origin.z, bits);
    rt_queue_put(queue, 3u, count, direction.x, bits);
    rt_queue_put(queue, 4u, count, direction.y, bits);
    rt_queue_put(queue, 5u, count, direction.z, bits);
    rt_queue_put(queue, 6u, count, weight.x, bits);
    rt_queue_put(queue, 7u, count, weight.y, bits);
    rt_queue_put(queue, 8u, count, weight.z, bits);
    rt_store(rt_as_vint(rt_compress(rt_as_vfloat(pixel), bits)), queue->pixel + count);
    return count + taken;
}

/* The area of the surface that rays start on travels with them, for structures that trace incoherent packets differently. */
#ifdef RT_SPLITS_INCOHERENT
#define RT_KEEP_AREA(queue, first, count, point, bits)                                                                         \
    if ((count) != (first)) rt_store(rt_compress((point)->area, bits), (queue)->area + (first));
#define RT_USE_AREA(generation, queue, base, ray, active)                                                                      \
    if ((generation) != 0u) (ray)->incoherent = rt_incoherent(ray, rt_load((queue)->area + (base)), rt_bits(active));
#else
#define RT_KEEP_AREA(queue, first, count, point, bits) (void)(first);
#define RT_USE_AREA(generation, queue, base, ray, active)
#endif

#ifdef RT_CARRIES_CONES
#define RT_KEEP_CONE(queue, first, count, way, bits) \
    if ((count) != (first)) rt_store(rt_compress(way, bits), (queue)->travelled + (first));
#else
#define RT_KEEP_CONE(queue, first, count, way, bits)
#endif

/* Loads RT_LANES rays from `base` on. */
RT_INLINE void rt_take(const rt_queue *queue, uint base, rt_rays *ray, rt_vec *weight, vint *pixel)
{
    ray->ox = rt_load(queue->field[0] + base);
    ray->oy = rt_load(queue->field[1] + base);
    ray->oz = rt_load(queue->field[2] + base);
    ray->dx = rt_load(queue->field[3] + base);
    ray->dy = rt_load(queue->field[4] + base);
    ray->dz = rt_load(queue->field[5] + base);
    ray->t_min = rt_vfloat(0.0f);
    *weight = rt_vec_of(rt_load(queue->field[6] + base), rt_load(queue->field[7] + base), rt_load(queue->field[8] + base));
    *pixel = rt_load(queue->pixel + base);
#ifdef RT_CARRIES_CONES
    ray->travelled = rt_load(queue->travelled + base);
#endif
}

#endif
