/* lanes.h -- one kernel source for any SIMD width. OpenCL C 1.2.
 *
 * RT_LANES is 1 on GPUs, where a work-item is a thread, and 4, 8 or 16 on CPUs, where a work-item drives one vector register.
 * vfloat, vint and vmask are scalars or vectors accordingly. A lane of a mask is 0 or -1. All control flow is uniform over the
 * lanes. The lanes are explicit because no OpenCL compiler for CPUs vectorises a divergent tree traversal across work-items. */
#ifndef RT_LANES_H
#define RT_LANES_H

#define RT_INLINE static inline __attribute__((always_inline))
/* Declares a kernel that makes pictures. With RT_FEWER_REGISTERS the host limits the registers of NVIDIA's compiler, which
 * obeys only where the kernel does not fix the size of its work-groups. */
#if defined(RT_FEWER_REGISTERS) && defined(__NV_CL_C_VERSION)
#define RT_PICTURE_KERNEL kernel void
#else
#define RT_PICTURE_KERNEL kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
#endif
#define RT_NOINLINE static __attribute__((noinline))
/* A long function that several places call, or one of the parts of a long kernel. Compiled once, programs of a CPU are ready in a third of the
 * time: PoCL compiles what stands in a kernel itself three times (the kernel, and two functions that loop over its work-groups), and the time of
 * a function grows faster than its length. A GPU has no cheap calls. */
#if RT_CPU
#define RT_CALLED RT_NOINLINE
#else
#define RT_CALLED RT_INLINE
#endif
/* What a kernel does for a group. With one lane it stands in the kernel: LLVM 15 crashes where such a function has arrays and textures. */
#if RT_LANES > 1
#define RT_GROUP_WORK RT_CALLED
#else
#define RT_GROUP_WORK RT_INLINE
#endif
/* A part of a kernel that is long only if surfaces have layers. A call costs the others more than it saves. */
#if defined(RT_LOBES) && (RT_LOBES & RT_LOBE_LAYERS)
#define RT_PART RT_CALLED
#else
#define RT_PART RT_INLINE
#endif
/* A traversal is such a part of paths. Other programs do little else than trace, and hold it themselves. */
#ifdef RT_KNOWS_LOBES
#define RT_TRAVERSAL RT_PART
#else
#define RT_TRAVERSAL RT_INLINE
#endif
#define RT_CAT_(a, b) a##b
#define RT_CAT(a, b) RT_CAT_(a, b)

/* Whether the compiler knows a builtin function. Clang says yes also where the machine lacks the instruction, so a caller asks for
 * the instruction set, too. Other architectures and simulators do not know it and take the portable form. */
#ifdef __has_builtin
#define RT_HAS_BUILTIN(name) __has_builtin(name)
#else
#define RT_HAS_BUILTIN(name) 0
#endif

#if RT_LANES == 1

typedef float vfloat;
typedef int vint;
typedef uint vuint;
typedef int vmask;
#define RT_MASK(c) (-(int)(c))
#define rt_any(m) ((m) != 0)
#define rt_bits(m) ((uint)(m)&1u)
#define rt_select(m, a, b) ((m) ? (a) : (b))
#define rt_vfloat(x) ((float)(x))
#define rt_vint(x) ((int)(x))
#define rt_load(p) (*(p))
#define rt_store(v, p) (*(p) = (v))
#define rt_to_float(v) ((float)(v))
#define rt_to_int(v) ((int)(v))
#define rt_as_vint(v) as_int(v)
#define rt_as_vfloat(v) as_float(v)
#define rt_lane_index() 0

#else

typedef RT_CAT(float, RT_LANES) vfloat;
typedef RT_CAT(int, RT_LANES) vint;
typedef RT_CAT(uint, RT_LANES) vuint;
typedef RT_CAT(int, RT_LANES) vmask;
#define RT_MASK(c) (c) /* a vector compare gives 0 / -1 */
#define rt_select(m, a, b) ((m) ? (a) : (b))
#define rt_vfloat(x) ((vfloat)(x))
#define rt_vint(x) ((vint)(x))
/* Loads and stores of arrays of floats or ints, which need not be aligned. PoCL's vload and vstore work in quarters. */
typedef vfloat rt_unaligned_vfloat __attribute__((aligned(4)));
typedef vint rt_unaligned_vint __attribute__((aligned(4)));
RT_INLINE __attribute__((overloadable)) vfloat rt_load(const float *p) { return *(const rt_unaligned_vfloat *)p; }
RT_INLINE __attribute__((overloadable)) vint rt_load(const int *p) { return *(const rt_unaligned_vint *)p; }
RT_INLINE __attribute__((overloadable)) void rt_store(vfloat v, float *p) { *(rt_unaligned_vfloat *)p = v; }
RT_INLINE __attribute__((overloadable)) void rt_store(vint v, int *p) { *(rt_unaligned_vint *)p = v; }
RT_INLINE __attribute__((overloadable)) void rt_store(vfloat v, global float *p) { *(global rt_unaligned_vfloat *)p = v; }
#define rt_to_float(v) RT_CAT(convert_float, RT_LANES)(v)
#define rt_to_int(v) RT_CAT(RT_CAT(convert_int, RT_LANES), _rtz)(v)
#define rt_as_vint(v) RT_CAT(as_int, RT_LANES)(v)
#define rt_as_vfloat(v) RT_CAT(as_float, RT_LANES)(v)
#if RT_LANES == 16
#define rt_lane_index() ((int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15))
#elif RT_LANES == 8
#define rt_lane_index() ((int8)(0, 1, 2, 3, 4, 5, 6, 7))
#else
#define rt_lane_index() ((int4)(0, 1, 2, 3))
#endif

/* rt_bits: the lanes of a mask as bits, lane 0 in bit 0. PoCL 3.1's any() tests lane after lane and costs a third of a frame;
 * the movemask instruction takes one cycle. RT_PORTABLE, a setting for tests, selects the fallback everywhere. */
#if !defined(RT_PORTABLE) && RT_LANES == 16 && defined(__AVX512DQ__) && RT_HAS_BUILTIN(__builtin_ia32_cvtd2mask512)
#define rt_bits(m) ((uint)(ushort)__builtin_ia32_cvtd2mask512(m))
#elif !defined(RT_PORTABLE) && RT_LANES == 8 && defined(__AVX__) && RT_HAS_BUILTIN(__builtin_ia32_movmskps256)
#define rt_bits(m) ((uint)__builtin_ia32_movmskps256(as_float8(m)))
#elif !defined(RT_PORTABLE) && RT_LANES == 4 && defined(__SSE__) && RT_HAS_BUILTIN(__builtin_ia32_movmskps)
#define rt_bits(m) ((uint)__builtin_ia32_movmskps(as_float4(m)))
#elif !defined(RT_PORTABLE) && RT_LANES == 16 && defined(__AVX__) && RT_HAS_BUILTIN(__builtin_ia32_movmskps256)
#define rt_bits(m)                                                                                                             \
    ((uint)__builtin_ia32_movmskps256(as_float8((m).lo)) | (uint)__builtin_ia32_movmskps256(as_float8((m).hi)) << 8)
#else
RT_INLINE uint rt_bits4(int4 m)
{
    const int4 weighted = m & (int4)(1, 2, 4, 8);
    const int2 pair = weighted.lo | weighted.hi;
    return (uint)(pair.x | pair.y);
}
#if RT_LANES == 4
#define rt_bits(m) rt_bits4(m)
#elif RT_LANES == 8
#define rt_bits(m) (rt_bits4((m).lo) | rt_bits4((m).hi) << 4)
#else
#define rt_bits(m) (rt_bits4((m).lo.lo) | rt_bits4((m).lo.hi) << 4 | rt_bits4((m).hi.lo) << 8 | rt_bits4((m).hi.hi) << 12)
#endif
#endif
#define rt_any(m) (rt_bits(m) != 0u)

#endif

#define rt_lowest(bits) popcount(~(bits) & ((bits)-1u)) /* the index of the lowest set bit */
#define RT_ALL_LANES ((1u << RT_LANES) - 1u)

/* The lanes that hold the same number are handled together:
 *     int id;
 *     vmask mine;
 *     for (rt_groups g = rt_group_lanes(numbers, bits); rt_next_group(&g, &id, &mine);) ...
 * takes every number of the lanes in `bits` once. mine: all lanes that hold it, also those outside of `bits`. */
typedef struct rt_groups {
    vint numbers;
    int of[RT_LANES];
    uint left;
} rt_groups;

RT_INLINE rt_groups rt_group_lanes(vint numbers, uint bits)
{
    rt_groups g;
    g.numbers = numbers;
    rt_store(numbers, g.of);
    g.left = bits;
    return g;
}

RT_INLINE bool rt_next_group(rt_groups *g, int *id, vmask *mine)
{
    if (g->left == 0u) return false;
#if RT_LANES == 1
    *id = g->numbers;
    *mine = RT_MASK(g->numbers == g->numbers);
    g->left = 0u;
#else
    *id = g->of[rt_lowest(g->left)];
    *mine = RT_MASK(g->numbers == rt_vint(*id));
    g->left &= ~rt_bits(*mine);
#endif
    return true;
}

/* Minimum and maximum in one instruction each. On a CPU fmin and fmax take three, since they must look for NaN. On a GPU they
 * take one, but a comparison and a selection take two, which costs an eighth of the time of all rays. */
#if RT_CPU
#define rt_min(a, b) ((a) < (b) ? (a) : (b))
#define rt_max(a, b) ((a) > (b) ? (a) : (b))
#else
#define rt_min(a, b) fmin(a, b)
#define rt_max(a, b) fmax(a, b)
#endif

#define RT_INFINITY ((vfloat)(INFINITY))

/* rt_greatest: the greatest lane as a scalar. */
#if RT_LANES == 1
#define rt_greatest(v) (v)
#else
RT_INLINE float rt_greatest4(float4 v)
{
    const float2 pair = rt_max(v.lo, v.hi);
    return rt_max(pair.x, pair.y);
}
#if RT_LANES == 4
#define rt_greatest(v) rt_greatest4(v)
#elif RT_LANES == 8
#define rt_greatest(v) rt_greatest4(rt_max((v).lo, (v).hi))
#else
RT_INLINE float rt_greatest(float16 v)
{
    const float8 half_of = rt_max(v.lo, v.hi);
    return rt_greatest4(rt_max(half_of.lo, half_of.hi));
}
#endif
#endif

/* The greatest and the least lane of those in a mask. */
#define rt_greatest_of(mask, v) rt_greatest(rt_select(mask, v, rt_vfloat(-MAXFLOAT)))
#define rt_least_of(mask, v) (-rt_greatest_of(mask, -(v)))

/* 1 if the stack has room for the entry `top`. Debug programs count a full stack instead of overflowing it; see CONTRACT.md. */
#if defined(RT_DEBUG) && defined(RT_STACK_GRANTED) /* see RT_GRANT_PUSHES */
#define RT_STACK_OK(top, size, hit) ((hit)->overflow++ < (hit)->granted && (top) < (size))
#elif defined(RT_DEBUG)
#define RT_STACK_OK(top, size, hit) ((top) < (size) ? 1 : ((hit)->overflow = 1, 0))
#else
#define RT_STACK_OK(top, size, hit) 1
#endif

#endif
