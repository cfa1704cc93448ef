/* vec.h -- three-dimensional vectors and colours of all lanes, for shading. Traversals name the components one by one. */
#ifndef RT_VEC_H
#define RT_VEC_H

typedef struct rt_vec {
    vfloat x, y, z;
} rt_vec;

RT_INLINE rt_vec rt_vec_of(vfloat x, vfloat y, vfloat z)
{
    rt_vec v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}
RT_INLINE rt_vec rt_splat(float x, float y, float z) { return rt_vec_of(rt_vfloat(x), rt_vfloat(y), rt_vfloat(z)); }
RT_INLINE rt_vec rt_spread(const global float *p) { return rt_splat(p[0], p[1], p[2]); }
RT_INLINE rt_vec rt_spread_constant(const constant float *p) { return rt_splat(p[0], p[1], p[2]); }
RT_INLINE rt_vec rt_add(rt_vec a, rt_vec b) { return rt_vec_of(a.x + b.x, a.y + b.y, a.z + b.z); }
RT_INLINE rt_vec rt_sub(rt_vec a, rt_vec b) { return rt_vec_of(a.x - b.x, a.y - b.y, a.z - b.z); }
RT_INLINE rt_vec rt_mul(rt_vec a, rt_vec b) { return rt_vec_of(a.x * b.x, a.y * b.y, a.z * b.z); }
RT_INLINE rt_vec rt_scale(vfloat s, rt_vec a) { return rt_vec_of(s * a.x, s * a.y, s * a.z); }
/* s a + b */
RT_INLINE rt_vec rt_along(vfloat s, rt_vec a, rt_vec b) { return rt_vec_of(fma(s, a.x, b.x), fma(s, a.y, b.y), fma(s, a.z, b.z)); }
RT_INLINE vfloat rt_dot(rt_vec a, rt_vec b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }
RT_INLINE rt_vec rt_cross(rt_vec a, rt_vec b)
{
    return rt_vec_of(fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x)));
}
RT_INLINE rt_vec rt_choose(vmask m, rt_vec a, rt_vec b)
{
    return rt_vec_of(rt_select(m, a.x, b.x), rt_select(m, a.y, b.y), rt_select(m, a.z, b.z));
}
/* 1 / length; finite for a null vector too. */
RT_INLINE vfloat rt_inverse_length(rt_vec a) { return rt_vfloat(1.0f) / sqrt(rt_max(rt_dot(a, a), rt_vfloat(1e-36f))); }
RT_INLINE rt_vec rt_normalize(rt_vec a) { return rt_scale(rt_inverse_length(a), a); }
/* Stores x, y, z and w of lane after lane. */
#if RT_LANES == 16 && RT_HAS_BUILTIN(__builtin_shufflevector)
RT_INLINE void rt_store_lanes(rt_vec v, float w, float4 *out)
{
    /* Shuffles stay within quarters of the register, where they are cheapest: lanes l, l + 4, l + 8 and l + 12 become a
     * vector. */
#define RT_EVEN(a, b) __builtin_shufflevector(a, b, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29)
#define RT_ODD(a, b) __builtin_shufflevector(a, b, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31)
#define RT_FIRST(a, b) __builtin_shufflevector(a, b, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29)
#define RT_SECOND(a, b) __builtin_shufflevector(a, b, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31)
    const float16 all_w = (float16)(w);
    const float16 xy_even = RT_EVEN(v.x, v.y), xy_odd = RT_ODD(v.x, v.y), z_even = RT_EVEN(v.z, all_w), z_odd = RT_ODD(v.z, all_w);
    const float16 four[4] = {RT_FIRST(xy_even, z_even), RT_SECOND(xy_even, z_even), RT_FIRST(xy_odd, z_odd), RT_SECOND(xy_odd, z_odd)};
    for (uint l = 0; l < 4u; ++l) {
        out[l] = four[l].s0123;
        out[l + 4u] = four[l].s4567;
        out[l + 8u] = four[l].s89ab;
        out[l + 12u] = four[l].scdef;
    }
#undef RT_EVEN
#undef RT_ODD
#undef RT_FIRST
#undef RT_SECOND
}
#else
RT_INLINE void rt_store_lanes(rt_vec v, float w, float4 *out)
{
    float x[RT_LANES], y[RT_LANES], z[RT_LANES];
    rt_store(v.x, x);
    rt_store(v.y, y);
    rt_store(v.z, z);
    for (uint l = 0; l < RT_LANES; ++l) out[l] = (float4)(x[l], y[l], z[l], w);
}
#endif
/* The vector of which rt_store_lanes() has stored x, y and z. */
RT_INLINE rt_vec rt_load_lanes(const float4 *in)
{
    float x[RT_LANES], y[RT_LANES], z[RT_LANES];
    for (uint l = 0; l < RT_LANES; ++l) x[l] = in[l].x, y[l] = in[l].y, z[l] = in[l].z;
    return rt_vec_of(rt_load(x), rt_load(y), rt_load(z));
}
RT_INLINE vfloat rt_largest(rt_vec a) { return rt_max(a.x, rt_max(a.y, a.z)); }

#endif
