/* ray_blocks.h -- the host's rays and their answers, in memory as a packet has them in registers.
 *
 * A block is RT_LANES rays, field by field: RT_LANES floats of origin x, then of y, z, t_min, direction x, y, z, t_max. Every
 * load is one aligned vector. Gathering from one ray after the other would cost 15 to 20 clocks a ray. With one lane a block is
 * an rt_ray.
 *
 * Answers have the same form, with as many fields as the host asks for:
 *   RT_ANSWER_ALL        t, u, v, prim, instance, and three of no value; with one lane an rt_hit
 *   RT_ANSWER_COUNTED    programs that count: t, u, v, prim, instance, steps, leaf_tests, lane_steps, and the members of a RayWork
 *   RT_ANSWER_HIT        t, u, v, prim: half the bytes, for one lane and scenes without instances
 *   RT_ANSWER_NEAREST    t, prim
 *   RT_ANSWER_OCCLUSION  t
 * The host fills the last block up with inactive rays. It packs and unpacks blocks in host/render/tracers/rays/ray_blocks.cpp. */
#ifndef RT_RAY_BLOCKS_H
#define RT_RAY_BLOCKS_H

/* t_max of a block; negative in inactive lanes. */
RT_INLINE vfloat rt_load_reach(const global float *blocks, uint block)
{
    return ((const global vfloat *)blocks)[RT_RAY_FIELDS * (size_t)block + 7u];
}

/* Prefetches the fields of the block one stream ahead, if it has rays, and the t_max of the block two streams ahead. `last`:
 * the last block. Without it a CPU waits for memory a sixth of the time of bunny's camera rays. */
RT_INLINE void rt_fetch_ahead(const global float *blocks, uint block, uint last)
{
#if RT_CPU && RT_LANES > 1 && RT_HAS_BUILTIN(__builtin_prefetch) && !defined(__SPIR__) /* simulators compile for SPIR */
    const uint next = min(block + RT_STREAM, last), after = min(next + RT_STREAM, last);
    const global vfloat *fields = (const global vfloat *)blocks;
    if (rt_any(RT_MASK(rt_load_reach(blocks, next) >= rt_vfloat(0.0f))))
        for (uint i = 0; i < 7u; ++i) __builtin_prefetch((const void *)(ulong)(fields + RT_RAY_FIELDS * (size_t)next + i));
    __builtin_prefetch((const void *)(ulong)(fields + RT_RAY_FIELDS * (size_t)after + 7u));
#endif
}

RT_INLINE void rt_load_ray_block(const constant rt_frame *frame, const global float *blocks, uint block, rt_rays *ray, vfloat *t_max)
{
    RT_SEEN_BY(ray, rt_vint((int)frame->ray_mask))
#if RT_LANES == 1
    const global float4 *in = (const global float4 *)blocks + 2u * (size_t)block; /* 16-byte loads */
    const float4 origin = in[0], direction = in[1];
    ray->ox = origin.x;
    ray->oy = origin.y;
    ray->oz = origin.z;
    ray->t_min = origin.w;
    ray->dx = direction.x;
    ray->dy = direction.y;
    ray->dz = direction.z;
    *t_max = direction.w;
#else
    const global vfloat *in = (const global vfloat *)blocks + RT_RAY_FIELDS * (size_t)block;
    ray->ox = in[0];
    ray->oy = in[1];
    ray->oz = in[2];
    ray->t_min = in[3];
    ray->dx = in[4];
    ray->dy = in[5];
    ray->dz = in[6];
    *t_max = in[7];
#endif
}

/* Stores an answer past the caches: a CPU then neither fetches the line that it overwrites nor keeps it. */
#if RT_CPU && RT_LANES > 1 && RT_HAS_BUILTIN(__builtin_nontemporal_store)
#define RT_STORE_NONTEMPORAL(out, v) __builtin_nontemporal_store(v, out)
#else
#define RT_STORE_NONTEMPORAL(out, v) (*(out) = (v))
#endif

RT_INLINE void rt_store_hit_block(global float *blocks, uint block, uint fields, const rt_hits *hit)
{
#if RT_LANES == 1
    if (fields == RT_ANSWER_HIT) {
        ((global float4 *)blocks)[block] = (float4)(hit->t, hit->u, hit->v, as_float(hit->prim));
        return;
    }
#endif
    global vfloat *block_fields = (global vfloat *)blocks + fields * (size_t)block;
#ifdef RT_COUNT_STEPS
    const uint counts[7] = {hit->steps, hit->leaf_tests, hit->lane_steps, hit->boxes, hit->own_steps, hit->own_boxes, hit->own_tests};
    block_fields[0] = hit->t;
    block_fields[1] = hit->u;
    block_fields[2] = hit->v;
    block_fields[3] = rt_as_vfloat(hit->prim);
    block_fields[4] = rt_as_vfloat(hit->instance);
    for (uint i = 0; i < 7u; ++i) block_fields[5u + i] = rt_as_vfloat(rt_vint((int)counts[i]));
#else
    if (fields != RT_ANSWER_ALL) {
        RT_STORE_NONTEMPORAL(block_fields, hit->t);
        if (fields == RT_ANSWER_NEAREST) RT_STORE_NONTEMPORAL(block_fields + 1, rt_as_vfloat(hit->prim));
        return;
    }
#if RT_LANES == 1
    global float4 *out = (global float4 *)blocks + 2u * (size_t)block;
    out[0] = (float4)(hit->t, hit->u, hit->v, as_float(hit->prim));
    out[1] = (float4)(as_float(hit->instance), 0.0f, 0.0f, 0.0f);
#else
    global vfloat *out = block_fields;
    out[0] = hit->t;
    out[1] = hit->u;
    out[2] = hit->v;
    out[3] = rt_as_vfloat(hit->prim);
    out[4] = rt_as_vfloat(hit->instance);
#endif
#endif
}

#endif
