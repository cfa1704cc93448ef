// vec4.hpp -- four floats in a register, by SSE2 where it exists, else by plain loops. Both variants give the same bits: all
// operations have the same order, and min and max are `a < b ? a : b`, as in MINPS and MAXPS.
#pragma once
#include <algorithm>
#include <cfloat>
#include <cstdint>
#include <cstring>
#if defined(__SSE2__) && !defined(CLARITY_BVH_PORTABLE)
#define CLARITY_BVH_SSE2 1
#include <emmintrin.h>
#endif

namespace clarity::bvh {

// Prefetches the cache line at p.
inline void fetch(const void* p) {
#ifdef __GNUC__
    __builtin_prefetch(p);
#else
    (void)p;
#endif
}
// Loops over many elements prefetch this many elements ahead. The hardware prefetcher looks less far ahead.
constexpr uint32_t kStreamAhead = 64;

#ifdef CLARITY_BVH_SSE2

struct Vec4 {
    __m128 m;
};
inline Vec4 load(const float* p) {
    return {_mm_load_ps(p)};
}  // 16-byte aligned
inline Vec4 load_any(const float* p) {
    return {_mm_loadu_ps(p)};
}
inline void store(float* p, Vec4 a) {
    _mm_store_ps(p, a.m);
}
inline void store_any(float* p, Vec4 a) {
    _mm_storeu_ps(p, a.m);
}
inline Vec4 splat(float x) {
    return {_mm_set1_ps(x)};
}
inline Vec4 operator+(Vec4 a, Vec4 b) {
    return {_mm_add_ps(a.m, b.m)};
}
inline Vec4 operator-(Vec4 a, Vec4 b) {
    return {_mm_sub_ps(a.m, b.m)};
}
inline Vec4 operator*(Vec4 a, Vec4 b) {
    return {_mm_mul_ps(a.m, b.m)};
}
inline Vec4 operator/(Vec4 a, Vec4 b) {
    return {_mm_div_ps(a.m, b.m)};
}
inline Vec4 min(Vec4 a, Vec4 b) {
    return {_mm_min_ps(a.m, b.m)};
}
inline Vec4 max(Vec4 a, Vec4 b) {
    return {_mm_max_ps(a.m, b.m)};
}
// A mask with all bits of a lane set where a < b, else none. NaN gives no bits.
inline Vec4 less(Vec4 a, Vec4 b) {
    return {_mm_cmplt_ps(a.m, b.m)};
}
// mask ? a : b, lane by lane.
inline Vec4 select(Vec4 mask, Vec4 a, Vec4 b) {
    return {_mm_or_ps(_mm_and_ps(mask.m, a.m), _mm_andnot_ps(mask.m, b.m))};
}
// The mask of lanes: bit i is set for lane i.
inline Vec4 mask_of(uint32_t bits) {
    const __m128i lanes = _mm_setr_epi32(1, 2, 4, 8);
    return {_mm_castsi128_ps(_mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(static_cast<int>(bits)), lanes), lanes))};
}
// Where a < b: b = a and index_b = index_a. index_a must not be below any index so far.
inline void keep_less(Vec4 a, Vec4 index_a, Vec4& b, Vec4& index_b) {
    index_b = max(index_b, {_mm_and_ps(less(a, b).m, index_a.m)});
    b = min(a, b);
}
// 1 if any lane of a mask is set, else 0.
inline uint32_t any(Vec4 mask) {
    return _mm_movemask_ps(mask.m) != 0;
}
// (x, y, z, 0), whatever bits the fourth lane held (an integer, for example).
inline Vec4 xyz(Vec4 a) {
    return {_mm_and_ps(a.m, _mm_castsi128_ps(_mm_setr_epi32(-1, -1, -1, 0)))};
}
// Truncates lanes 0..2. They must be within [0, 32767].
inline void to_index(Vec4 a, uint32_t index[3]) {
    const __m128i i = _mm_cvttps_epi32(a.m);
    index[0] = static_cast<uint32_t>(_mm_extract_epi16(i, 0));
    index[1] = static_cast<uint32_t>(_mm_extract_epi16(i, 2));
    index[2] = static_cast<uint32_t>(_mm_extract_epi16(i, 4));
}
// Tags make equal numbers distinct: the lowest bits of every lane become those of `tag` (tag_lanes adds 0, 1, 2, 3 to it by
// lane). Zeros and denormals first become the smallest normal number, because threads that flush denormals to 0 (as Embree's
// do) would lose their tags.
constexpr uint32_t kTags = 64;
inline __m128i room_for_tag(Vec4 a) {
    const __m128i bits = _mm_castps_si128(a.m), exponent = _mm_set1_epi32(0x7f800000), least = _mm_set1_epi32(0x00800000);
    const __m128i tiny = _mm_cmpeq_epi32(_mm_and_si128(bits, exponent), _mm_setzero_si128());
    return _mm_and_si128(_mm_or_si128(bits, _mm_and_si128(tiny, least)), _mm_set1_epi32(-static_cast<int>(kTags)));
}
inline Vec4 tag_all(Vec4 a, uint32_t tag) {
    return {_mm_castsi128_ps(_mm_or_si128(room_for_tag(a), _mm_set1_epi32(static_cast<int>(tag))))};
}
inline Vec4 tag_lanes(Vec4 a, uint32_t tag) {
    const __m128i bits = room_for_tag(a);
    const __m128i tags = _mm_add_epi32(_mm_set1_epi32(static_cast<int>(tag)), _mm_setr_epi32(0, 1, 2, 3));
    return {_mm_castsi128_ps(_mm_or_si128(bits, tags))};
}
inline void store_tags(uint32_t* p, Vec4 a) {
    _mm_store_si128(reinterpret_cast<__m128i*>(p),
                    _mm_and_si128(_mm_castps_si128(a.m), _mm_set1_epi32(static_cast<int>(kTags) - 1)));
}
// Transposes the rows a, b, c: x = (a.x b.x c.x ?), and so on.
inline void transpose3(Vec4 a, Vec4 b, Vec4 c, Vec4& x, Vec4& y, Vec4& z) {
    const __m128 low = _mm_unpacklo_ps(a.m, b.m), high = _mm_unpackhi_ps(a.m, b.m);
    x.m = _mm_movelh_ps(low, c.m);
    y.m = _mm_shuffle_ps(low, c.m, _MM_SHUFFLE(1, 1, 3, 2));
    z.m = _mm_shuffle_ps(high, c.m, _MM_SHUFFLE(2, 2, 1, 0));
}
// Transposes the rows a, b, c, d: x = (a.x b.x c.x d.x), and so on.
inline void transpose4(Vec4 a, Vec4 b, Vec4 c, Vec4 d, Vec4& x, Vec4& y, Vec4& z) {
    const __m128 low = _mm_unpacklo_ps(a.m, b.m), low2 = _mm_unpacklo_ps(c.m, d.m);
    x.m = _mm_movelh_ps(low, low2);
    y.m = _mm_movehl_ps(low2, low);
    z.m = _mm_movelh_ps(_mm_unpackhi_ps(a.m, b.m), _mm_unpackhi_ps(c.m, d.m));
}
// The least and the greatest lane.
inline float least(Vec4 a) {
    const __m128 two = _mm_min_ps(a.m, _mm_movehl_ps(a.m, a.m));
    return _mm_cvtss_f32(_mm_min_ss(two, _mm_shuffle_ps(two, two, 1)));
}
inline float greatest(Vec4 a) {
    const __m128 two = _mm_max_ps(a.m, _mm_movehl_ps(a.m, a.m));
    return _mm_cvtss_f32(_mm_max_ss(two, _mm_shuffle_ps(two, two, 1)));
}
// Four unsigned counters, each below 2^31; to_float() relies on this limit.
struct Count4 {
    __m128i m;
};
inline Count4 load_counts(const uint32_t* p) {
    return {_mm_load_si128(reinterpret_cast<const __m128i*>(p))};
}
inline void store_counts(uint32_t* p, Count4 a) {
    _mm_store_si128(reinterpret_cast<__m128i*>(p), a.m);
}
inline Count4 operator+(Count4 a, Count4 b) {
    return {_mm_add_epi32(a.m, b.m)};
}
inline Vec4 to_float(Count4 a) {
    return {_mm_cvtepi32_ps(a.m)};
}

#else

struct Vec4 {
    float v[4];
};
template <class F>
inline Vec4 each_lane(F f) {
    Vec4 r;
    for (int i = 0; i < 4; ++i) r.v[i] = f(i);
    return r;
}
inline Vec4 load(const float* p) {
    return each_lane([&](int i) { return p[i]; });
}
inline Vec4 load_any(const float* p) {
    return load(p);
}
inline void store(float* p, Vec4 a) {
    std::memcpy(p, a.v, sizeof a.v);
}
inline void store_any(float* p, Vec4 a) {
    store(p, a);
}
inline Vec4 splat(float x) {
    return {{x, x, x, x}};
}
inline Vec4 operator+(Vec4 a, Vec4 b) {
    return each_lane([&](int i) { return a.v[i] + b.v[i]; });
}
inline Vec4 operator-(Vec4 a, Vec4 b) {
    return each_lane([&](int i) { return a.v[i] - b.v[i]; });
}
inline Vec4 operator*(Vec4 a, Vec4 b) {
    return each_lane([&](int i) { return a.v[i] * b.v[i]; });
}
inline Vec4 operator/(Vec4 a, Vec4 b) {
    return each_lane([&](int i) { return a.v[i] / b.v[i]; });
}
inline Vec4 min(Vec4 a, Vec4 b) {
    return each_lane([&](int i) { return a.v[i] < b.v[i] ? a.v[i] : b.v[i]; });
}
inline Vec4 max(Vec4 a, Vec4 b) {
    return each_lane([&](int i) { return a.v[i] > b.v[i] ? a.v[i] : b.v[i]; });
}
// In this variant a lane of a mask is 1 or 0. Only select() and any() read masks.
inline Vec4 less(Vec4 a, Vec4 b) {
    return each_lane([&](int i) { return a.v[i] < b.v[i] ? 1.0f : 0.0f; });
}
inline Vec4 select(Vec4 mask, Vec4 a, Vec4 b) {
    return each_lane([&](int i) { return mask.v[i] != 0.0f ? a.v[i] : b.v[i]; });
}
inline Vec4 mask_of(uint32_t bits) {
    return each_lane([&](int i) { return static_cast<float>(bits >> i & 1u); });
}
inline void keep_less(Vec4 a, Vec4 index_a, Vec4& b, Vec4& index_b) {
    index_b = max(index_b, select(less(a, b), index_a, splat(0.0f)));
    b = min(a, b);
}
inline uint32_t any(Vec4 mask) {
    return mask.v[0] + mask.v[1] + mask.v[2] + mask.v[3] != 0.0f;
}
inline Vec4 xyz(Vec4 a) {
    return {{a.v[0], a.v[1], a.v[2], 0.0f}};
}
inline void to_index(Vec4 a, uint32_t index[3]) {
    for (int i = 0; i < 3; ++i) index[i] = static_cast<uint32_t>(a.v[i]);
}
constexpr uint32_t kTags = 64;
inline float tagged(float a, uint32_t tag) {
    uint32_t bits;
    std::memcpy(&bits, &a, sizeof bits);
    if ((bits & 0x7f800000u) == 0) bits |= 0x00800000u;
    bits = (bits & ~(kTags - 1)) | tag;
    std::memcpy(&a, &bits, sizeof bits);
    return a;
}
inline Vec4 tag_all(Vec4 a, uint32_t tag) {
    return each_lane([&](int i) { return tagged(a.v[i], tag); });
}
inline Vec4 tag_lanes(Vec4 a, uint32_t tag) {
    return each_lane([&](int i) { return tagged(a.v[i], tag + static_cast<uint32_t>(i)); });
}
inline void store_tags(uint32_t* p, Vec4 a) {
    std::memcpy(p, a.v, sizeof a.v);
    for (int i = 0; i < 4; ++i) p[i] &= kTags - 1;
}
inline void transpose3(Vec4 a, Vec4 b, Vec4 c, Vec4& x, Vec4& y, Vec4& z) {
    x = {{a.v[0], b.v[0], c.v[0], 0.0f}};
    y = {{a.v[1], b.v[1], c.v[1], 0.0f}};
    z = {{a.v[2], b.v[2], c.v[2], 0.0f}};
}
inline void transpose4(Vec4 a, Vec4 b, Vec4 c, Vec4 d, Vec4& x, Vec4& y, Vec4& z) {
    x = {{a.v[0], b.v[0], c.v[0], d.v[0]}};
    y = {{a.v[1], b.v[1], c.v[1], d.v[1]}};
    z = {{a.v[2], b.v[2], c.v[2], d.v[2]}};
}
inline float least(Vec4 a) {
    return std::min(std::min(a.v[0], a.v[1]), std::min(a.v[2], a.v[3]));
}
inline float greatest(Vec4 a) {
    return std::max(std::max(a.v[0], a.v[1]), std::max(a.v[2], a.v[3]));
}
struct Count4 {
    uint32_t v[4];
};
inline Count4 load_counts(const uint32_t* p) {
    return {{p[0], p[1], p[2], p[3]}};
}
inline void store_counts(uint32_t* p, Count4 a) {
    std::memcpy(p, a.v, sizeof a.v);
}
inline Count4 operator+(Count4 a, Count4 b) {
    return {{a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2], a.v[3] + b.v[3]}};
}
inline Vec4 to_float(Count4 a) {
    return each_lane([&](int i) { return static_cast<float>(a.v[i]); });
}

#endif

}  // namespace clarity::bvh
