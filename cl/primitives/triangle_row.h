/* triangle_row.h -- one ray against four triangles that are neighbours in leaf order: the bits of those that it may hit.
 *
 * The edge functions are those of triangle.h, operation by operation, so no triangle is lost, not even where one is NaN.
 * triangle_single_ray.h decides the rest. Hardly more than one triangle a ray comes to it.
 *
 * Four triangles are twelve quads of 16 bytes, three vectors of sixteen floats. For one axis of the ray, a permutation within
 * quads takes the coordinate out of each, and a merge of the three vectors gives all twelve in one. So records need no
 * transposition.
 *
 * Reads RT_ROW triangles from `leaf` on, whatever they are; the host pads the buffer. */
#ifndef RT_TRIANGLE_ROW_H
#define RT_TRIANGLE_ROW_H

#define RT_ROW 4u

#if !defined(RT_PORTABLE) && defined(__AVX512DQ__) && defined(__AVX512VL__) && RT_HAS_BUILTIN(__builtin_ia32_cvtd2mask512) &&  \
    RT_HAS_BUILTIN(__builtin_ia32_selectps_512) && RT_HAS_BUILTIN(__builtin_ia32_vpermilvarps512)

typedef float rt_unaligned16 __attribute__((ext_vector_type(16), aligned(16)));

/* The coordinate `axis` of twelve quads, four in each vector. That of quad q of vector i goes to lane 4 q + i. */
RT_INLINE float16 rt_row_coordinates(float16 quads0, float16 quads1, float16 quads2, int axis)
{
    const int16 pick = (int16)(axis);
    const float16 two = __builtin_ia32_selectps_512(0x2222, __builtin_ia32_vpermilvarps512(quads1, pick),
                                                    __builtin_ia32_vpermilvarps512(quads0, pick));
    return __builtin_ia32_selectps_512(0x4444, __builtin_ia32_vpermilvarps512(quads2, pick), two);
}

RT_INLINE uint rt_row_candidates(const rt_single_rays *r, uint l, const global rt_packed_prim *leaf)
{
#pragma OPENCL FP_CONTRACT OFF
    const global float *words = (const global float *)leaf;
    const float16 quads0 = *(const global rt_unaligned16 *)words, quads1 = *(const global rt_unaligned16 *)(words + 16),
                  quads2 = *(const global rt_unaligned16 *)(words + 32);
    const float16 z = (float16)(RT_AT(r->pz, l)) - rt_row_coordinates(quads0, quads1, quads2, (int)RT_AT(r->kz, l));
    const float16 x = RT_SHEARED((float16)(RT_AT(r->sx, l)), z, (float16)(RT_AT(r->px, l)),
                                 rt_row_coordinates(quads0, quads1, quads2, (int)RT_AT(r->kx, l)));
    const float16 y = RT_SHEARED((float16)(RT_AT(r->sy, l)), z, (float16)(RT_AT(r->py, l)),
                                 rt_row_coordinates(quads0, quads1, quads2, (int)RT_AT(r->ky, l)));
    /* Corners a are in lanes 0, 12, 9, 6, corners b in 4, 1, 13, 10, corners c in 8, 5, 2, 14. The edge functions of triangle i
     * are in lanes i, i + 4 and i + 8. */
    const float16 x0 = x.s0c9641da852e0000, y0 = y.s0c9641da852e0000, x1 = x.s41da852e0c960000, y1 = y.s41da852e0c960000;
    const float16 edge = RT_EDGE(x0, y0, x1, y1);
    uint bits = (ushort)__builtin_ia32_cvtd2mask512(~(edge < (float16)(0.0f))) |
                (uint)(ushort)__builtin_ia32_cvtd2mask512(~(edge > (float16)(0.0f))) << 16;
    bits &= bits >> 4 & bits >> 8;
    return (bits | bits >> 16) & 15u;
}

#else

/* One corner of each of four triangles in ray space. */
RT_INLINE void rt_row_corners(const global float4 *quads, const rt_single_rays *r, uint l, float4 *x, float4 *y, float4 *z)
{
#pragma OPENCL FP_CONTRACT OFF
    float4 q0 = quads[0], q1 = quads[3], q2 = quads[6], q3 = quads[9];
    const int kz = (int)RT_AT(r->kz, l);
    const float4 c0 = (float4)(q0.x, q1.x, q2.x, q3.x), c1 = (float4)(q0.y, q1.y, q2.y, q3.y), c2 = (float4)(q0.z, q1.z, q2.z, q3.z);
    *z = (float4)(RT_AT(r->pz, l)) - (kz == 2 ? c2 : kz == 1 ? c1 : c0);
    *x = RT_SHEARED((float4)(RT_AT(r->sx, l)), *z, (float4)(RT_AT(r->px, l)), (kz == 2 ? c0 : kz == 1 ? c2 : c1));
    *y = RT_SHEARED((float4)(RT_AT(r->sy, l)), *z, (float4)(RT_AT(r->py, l)), (kz == 2 ? c1 : kz == 1 ? c0 : c2));
}

RT_INLINE uint rt_row_candidates(const rt_single_rays *r, uint l, const global rt_packed_prim *leaf)
{
#pragma OPENCL FP_CONTRACT OFF
    const global float4 *quads = (const global float4 *)leaf;
    float4 ax, ay, az, bx, by, bz, cx, cy, cz;
    rt_row_corners(quads, r, l, &ax, &ay, &az);
    rt_row_corners(quads + 1, r, l, &bx, &by, &bz);
    rt_row_corners(quads + 2, r, l, &cx, &cy, &cz);
    const float4 u = RT_EDGE(cx, cy, bx, by), v = RT_EDGE(ax, ay, cx, cy), w = RT_EDGE(bx, by, ax, ay), zero = (float4)(0.0f);
    const int4 inside = ~((u < zero) | (v < zero) | (w < zero)) | ~((u > zero) | (v > zero) | (w > zero));
#if !defined(RT_PORTABLE) && defined(__SSE__) && RT_HAS_BUILTIN(__builtin_ia32_movmskps)
    return (uint)__builtin_ia32_movmskps(as_float4(inside));
#else
    const int4 weighted = inside & (int4)(1, 2, 4, 8);
    return (uint)(weighted.x | weighted.y | weighted.z | weighted.w);
#endif
}

#endif
#endif
