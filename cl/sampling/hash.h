/* hash.h -- pseudo-random bits from integers, for all lanes. Integers only, so that all lane counts and devices agree. */
#ifndef RT_HASH_H
#define RT_HASH_H

#define rt_vuint(x) ((vuint)(x))
#if RT_LANES == 1
#define rt_as_vuint(v) as_uint(v)
#else
#define rt_as_vuint(v) RT_CAT(as_uint, RT_LANES)(v)
#endif

typedef struct rt_hashes {
    vuint a, b, c, d;
} rt_hashes;

RT_INLINE void rt_stir(rt_hashes *h)
{
    h->a += h->b * h->d;
    h->b += h->c * h->a;
    h->c += h->a * h->b;
    h->d += h->b * h->c;
}

/* Four hashes of four numbers: pcg4d of Jarzynski, Olano 2020, Hash Functions for GPU Rendering. */
RT_INLINE rt_hashes rt_hash(vuint a, vuint b, vuint c, vuint d)
{
    const vuint factor = rt_vuint(1664525u), step = rt_vuint(1013904223u);
    rt_hashes h;
    h.a = a * factor + step;
    h.b = b * factor + step;
    h.c = c * factor + step;
    h.d = d * factor + step;
    rt_stir(&h);
    h.a ^= h.a >> rt_vuint(16u);
    h.b ^= h.b >> rt_vuint(16u);
    h.c ^= h.c >> rt_vuint(16u);
    h.d ^= h.d >> rt_vuint(16u);
    rt_stir(&h);
    return h;
}

/* The upper 24 bits as a number in [0, 1). */
RT_INLINE vfloat rt_unit_interval(vuint bits)
{
    return rt_to_float(rt_as_vint(bits >> rt_vuint(8u))) * rt_vfloat(5.9604645e-8f);
}

#endif
