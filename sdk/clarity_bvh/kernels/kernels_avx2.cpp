// The kernels compiled for machines with AVX2. Every header that they need is included before the target pragma, so that no
// inline function shared with other files is compiled for AVX2.
#include "clarity_bvh/kernels/kernels.hpp"

#ifdef CLARITY_BVH_AVX2
#include <immintrin.h>

#define CLARITY_BVH_ISA_AVX2 1
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2")
#endif

#include "clarity_bvh/kernels/kernels.inl"

#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif
