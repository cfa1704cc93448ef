/* vec.h -- three-dimensional vectors and colours of all lanes, for shading. Traversal spells its components out. */
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
RT_INLINE rt_vec rt_add(rt_vec a, rt_vec b) { return rt_vec_of(a.x + b.x, a.y + b.y, a.z + b.z); }
RT_INLINE rt_vec rt_sub(rt_vec a, rt_vec b) { return rt_vec_of(a.x - b.x, a.y - b.y, a.z - b.z); }
RT_INLINE rt_vec rt_mul(rt_vec a, rt_vec b) { return rt_vec_of(a.x * b.x, a.y * b.y, a.z * b.z); }
RT_INLINE rt_vec rt_scale(vfloat s, rt_vec a) { return rt_vec_of(s * a.x, s * a.y, s * a.z); }
/* s a + b */
RT_INLINE rt_vec rt_along(vfloat s, rt_vec a, rt_vec b) { return rt_vec_of(fma(s, a.x, b.x), fma(s, a.y, b.y), fma(s, a.z, b.z)); }
RT_INLINE vfloat rt_dot(rt_vec a, rt_vec b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }
RT_INLINE rt_vec rt_choose(vmask m, rt_vec a, rt_vec b)
{
    return rt_vec_of(rt_select(m, a.x, b.x), rt_select(m, a.y, b.y), rt_select(m, a.z, b.z));
}
/* 1 / length; finite also for a null vector. */
RT_INLINE vfloat rt_inverse_length(rt_vec a) { return rt_vfloat(1.0f) / sqrt(rt_max(rt_dot(a, a), rt_vfloat(1e-36f))); }
RT_INLINE rt_vec rt_normalize(rt_vec a) { return rt_scale(rt_inverse_length(a), a); }
RT_INLINE vfloat rt_largest(rt_vec a) { return rt_max(a.x, rt_max(a.y, a.z)); }

#endif
