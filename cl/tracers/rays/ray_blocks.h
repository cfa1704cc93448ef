/* ray_blocks.h -- the host's rays and their answers, in memory as a packet has them in registers.
 *
 * A block is RT_LANES rays, field by field: RT_LANES floats of origin x, then of y, z, t_min, direction x, y, z, t_max. Every
 * load is one aligned vector. Gathering from one ray after the other would cost 15 to 20 clocks a ray. With one lane a block is
 * an rt_ray.
 *
 * Answers are arrays, one after the other, of `stride` numbers each, so that the host copies none but those that somebody reads. It
 * asks for so many of them, and those of these rays lie behind those of `before` others:
 *   RT_ANSWER_OCCLUSION  t
 *   RT_ANSWER_NEAREST    t, prim
 *   RT_ANSWER_HIT        t, prim, and u and v of each ray side by side, which take two places
 *   RT_ANSWER_PLACED     these, and instance
 *   programs that count: these, and RT_HIT_COUNTERS
 * The host fills the last block up with inactive rays. It packs rays and unpacks answers in
 * host/tracers/rays/ray_blocks.cpp.
 *
 * All rays of callers enter here, so the rule for their directions stands here and nowhere else. A ray hits nothing if its direction is
 * zero or not finite, or has no component of at least RT_LEAST_DIRECTION. Any other direction is right, however long it is: one far from
 * the length 1 is multiplied by a power of two, which is exact, and so are the ray's distances by its inverse. For traversals hold lengths
 * near 1: a component of 0 counts as 2^-80 in boxes (rays.h), which a direction of 2^-40 would take for a slope. */
#ifndef RT_RAY_BLOCKS_H
#define RT_RAY_BLOCKS_H

/* With 2^-60 the distance to anything in a scene, whose coordinates are at most 1e15, is a float. */
#define RT_LEAST_DIRECTION 8.6736174e-19f
/* Directions whose largest component is from 1/16 to 16 stay as they are. */
#define RT_LEAST_USUAL_DIRECTION 0.0625f
#define RT_MOST_USUAL_DIRECTION 16.0f

/* The power of two by which a ray is traced with a longer direction: 1 for usual directions, 0 for those that hit nothing. By bits, as
 * integers: so a NaN is greater than infinity, and no compiler takes numbers for finite. */
RT_INLINE vfloat rt_direction_scale(vfloat x, vfloat y, vfloat z)
{
    const vint size = rt_vint(0x7FFFFFFF), infinite = rt_vint(0x7F800000);
    const vint bx = rt_as_vint(x) & size, by = rt_as_vint(y) & size, bz = rt_as_vint(z) & size;
    const vint xy = rt_select(RT_MASK(bx > by), bx, by), largest = rt_select(RT_MASK(xy > bz), xy, bz);
    const vmask usual =
        RT_MASK(largest >= rt_vint(as_int(RT_LEAST_USUAL_DIRECTION))) & RT_MASK(largest <= rt_vint(as_int(RT_MOST_USUAL_DIRECTION)));
    if (rt_bits(usual) == RT_ALL_LANES) return rt_vfloat(1.0f);
    const vmask is_ray = RT_MASK(largest >= rt_vint(as_int(RT_LEAST_DIRECTION))) & RT_MASK(largest < infinite);
    /* 2^(1 - e) for a component of 2^e or more, which becomes 2 to 4: a power whose inverse is a normal number, too. */
    const vfloat scale = rt_as_vfloat(infinite - (largest & infinite));
    return rt_select(usual, rt_vfloat(1.0f), rt_select(is_ray, scale, rt_vfloat(0.0f)));
}

/* 1 / 2^k, exactly. */
#define RT_INVERSE_POWER(power) rt_as_vfloat(rt_vint(0x7F000000) - rt_as_vint(power))

/* t_max of a block as the caller gave it; negative in inactive lanes. */
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

/* *t_max: negative in lanes that hit nothing: inactive ones, and those whose directions are none. */
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
    const vfloat scale = rt_direction_scale(ray->dx, ray->dy, ray->dz);
    if (rt_bits(RT_MASK(scale == rt_vfloat(1.0f))) == RT_ALL_LANES) return;
    const vfloat shorter = RT_INVERSE_POWER(scale);
    ray->dx *= scale;
    ray->dy *= scale;
    ray->dz *= scale;
    ray->t_min *= shorter;
    *t_max = rt_select(RT_MASK(scale == rt_vfloat(0.0f)), rt_vfloat(-1.0f), *t_max * shorter);
}

/* The scale of a block's directions, for distances: one that the caller gave, times RT_INVERSE_POWER(scale), is one of the ray; one that a
 * traversal has found, times the scale, is one for the caller. */
RT_INLINE vfloat rt_scale_of_block(const global float *blocks, uint block)
{
#if RT_LANES == 1
    const float4 direction = ((const global float4 *)blocks)[2u * (size_t)block + 1u];
    return rt_direction_scale(direction.x, direction.y, direction.z);
#else
    const global vfloat *in = (const global vfloat *)blocks + RT_RAY_FIELDS * (size_t)block;
    return rt_direction_scale(in[4], in[5], in[6]);
#endif
}

/* Stores an answer past the caches: a CPU then neither fetches the line that it overwrites nor keeps it. */
#if RT_CPU && RT_LANES > 1 && RT_HAS_BUILTIN(__builtin_nontemporal_store)
#define RT_STORE_NONTEMPORAL(out, v) __builtin_nontemporal_store(v, out)
#else
#define RT_STORE_NONTEMPORAL(out, v) (*(out) = (v))
#endif

/* u and v of the first and of the second half of a block, side by side. */
#if RT_LANES == 4
#define RT_SIDE_BY_SIDE(u, v) (vfloat)((u).s0, (v).s0, (u).s1, (v).s1)
#elif RT_LANES == 8
#define RT_SIDE_BY_SIDE(u, v) (vfloat)((u).s0, (v).s0, (u).s1, (v).s1, (u).s2, (v).s2, (u).s3, (v).s3)
#elif RT_LANES == 16
#define RT_SIDE_BY_SIDE(u, v)                                                                                                     \
    (vfloat)((u).s0, (v).s0, (u).s1, (v).s1, (u).s2, (v).s2, (u).s3, (v).s3, (u).s4, (v).s4, (u).s5, (v).s5, (u).s6, (v).s6,      \
             (u).s7, (v).s7)
#endif

RT_INLINE void rt_store_weights(global float *to, uint block, const rt_hits *hit)
{
#if RT_LANES == 1
    ((global float2 *)to)[block] = (float2)(hit->u, hit->v);
#else
    global vfloat *pairs = (global vfloat *)to + 2u * (size_t)block;
    RT_STORE_NONTEMPORAL(pairs, RT_SIDE_BY_SIDE(hit->u.lo, hit->v.lo));
    RT_STORE_NONTEMPORAL(pairs + 1, RT_SIDE_BY_SIDE(hit->u.hi, hit->v.hi));
#endif
}

RT_INLINE void rt_store_hit_block(global float *answers, uint block, uint fields, uint stride, uint before, const rt_hits *hit)
{
#define RT_ANSWER_OF(field) ((global vfloat *)(answers + (field) * (size_t)stride + before) + block)
    RT_STORE_NONTEMPORAL(RT_ANSWER_OF(0u), hit->t);
    if (fields == RT_ANSWER_OCCLUSION) return;
    RT_STORE_NONTEMPORAL(RT_ANSWER_OF(1u), rt_as_vfloat(hit->prim));
    if (fields == RT_ANSWER_NEAREST) return;
    rt_store_weights(answers + 2u * ((size_t)stride + before), block, hit);
    if (fields == RT_ANSWER_HIT) return;
    RT_STORE_NONTEMPORAL(RT_ANSWER_OF(4u), rt_as_vfloat(hit->instance));
#ifdef RT_COUNT_STEPS
#define RT_COUNTER_OF_HIT(name, how, of_hit) hit->name,
    const uint counts[RT_HIT_COUNTER_COUNT] = {RT_HIT_COUNTERS(RT_COUNTER_OF_HIT)};
#undef RT_COUNTER_OF_HIT
    for (uint i = 0; i < RT_HIT_COUNTER_COUNT; ++i) *RT_ANSWER_OF(RT_ANSWER_PLACED + i) = rt_as_vfloat(rt_vint((int)counts[i]));
#endif
#undef RT_ANSWER_OF
}

#endif
