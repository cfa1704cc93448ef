// box8.inl -- a box in registers: eight floats in one register with AVX2, else two registers of four. Both variants do the same
// operations and give the same bits.
// Each kernels*.cpp includes this file once, for its instruction set.
#ifdef CLARITY_BVH_ISA_AVX2
#define CLARITY_BVH_ISA avx2
#else
#define CLARITY_BVH_ISA generic
#endif

namespace clarity::bvh {
namespace CLARITY_BVH_ISA {

#ifdef CLARITY_BVH_ISA_AVX2

struct Box8 {
    __m256 m;
};
// Unaligned loads and stores on purpose. GCC 12 places objects that a call returns at multiples of 16 bytes, even if their type
// asks for 32; and aligned forms would gain nothing.
inline Box8 load_box(const float* p) {
    return {_mm256_loadu_ps(p)};
}
inline void store_box(float* p, Box8 a) {
    _mm256_storeu_ps(p, a.m);
}
inline Vec4 low(Box8 a) {
    return {_mm256_castps256_ps128(a.m)};
}
inline Vec4 neg_high(Box8 a) {
    return {_mm256_extractf128_ps(a.m, 1)};
}
inline Box8 join(Vec4 lo, Vec4 neg_hi) {
    return {_mm256_insertf128_ps(_mm256_castps128_ps256(lo.m), neg_hi.m, 1)};
}
inline Box8 min(Box8 a, Box8 b) {
    return {_mm256_min_ps(a.m, b.m)};
}
inline Box8 operator-(Box8 a, Box8 b) {
    return {_mm256_sub_ps(a.m, b.m)};
}
inline Box8 operator*(Box8 a, Box8 b) {
    return {_mm256_mul_ps(a.m, b.m)};
}
inline Box8 operator+(Box8 a, Box8 b) {
    return {_mm256_add_ps(a.m, b.m)};
}
inline Box8 all_eight(float x) {
    return {_mm256_set1_ps(x)};
}
inline Box8 load_eight(const float* p) {
    return {_mm256_loadu_ps(p)};
}
// Where a < b: b = a and index_b = index_a. index_a must not be below any index so far.
inline void keep_less(Box8 a, Box8 index_a, Box8& b, Box8& index_b) {
    index_b.m = _mm256_max_ps(index_b.m, _mm256_and_ps(_mm256_cmp_ps(a.m, b.m, _CMP_LT_OQ), index_a.m));
    b.m = _mm256_min_ps(a.m, b.m);
}
inline Box8 no_box() {
    return {_mm256_set1_ps(FLT_MAX)};
}
// A point box at twice the centroid of a box.
inline Box8 centroid2_box(Box8 a) {
    return {_mm256_sub_ps(a.m, _mm256_permute2f128_ps(a.m, a.m, 1))};
}
// The box of a record. The lane that holds the ref is cleared.
inline Box8 box_of(const Record& r) {
    return {_mm256_and_ps(_mm256_loadu_ps(r.lo), _mm256_castsi256_ps(_mm256_setr_epi32(-1, -1, -1, 0, -1, -1, -1, -1)))};
}
inline Box8 max(Box8 a, Box8 b) {
    return {_mm256_max_ps(a.m, b.m)};
}
// The maximum of the eight lanes, in all lanes.
inline Box8 highest(Box8 a) {
    __m256 m = _mm256_max_ps(a.m, _mm256_permute2f128_ps(a.m, a.m, 1));
    m = _mm256_max_ps(m, _mm256_permute_ps(m, _MM_SHUFFLE(1, 0, 3, 2)));
    return {_mm256_max_ps(m, _mm256_permute_ps(m, _MM_SHUFFLE(2, 3, 0, 1)))};
}
// Copies one of the lower four lanes to all eight.
inline Box8 lane_in_all(Box8 a, int lane) {
    return {_mm256_permutevar8x32_ps(a.m, _mm256_set1_epi32(lane))};
}
// less() gives a mask of the lanes where a < b; first_of() gives the first lane of a mask as 1 or 0.
inline Box8 less(Box8 a, Box8 b) {
    return {_mm256_cmp_ps(a.m, b.m, _CMP_LT_OQ)};
}
inline uint32_t first_of(Box8 mask) {
    return static_cast<uint32_t>(_mm256_movemask_ps(mask.m)) & 1u;
}
// The minimum of a and b, except in lanes where the mask is set (min_unless) or not set (min_where): those keep b. A masked
// lane of a becomes NaN, and the minimum then returns its second operand.
inline Box8 min_unless(Box8 mask, Box8 a, Box8 b) {
    return {_mm256_min_ps(_mm256_or_ps(a.m, mask.m), b.m)};
}
inline Box8 min_where(Box8 mask, Box8 a, Box8 b) {
    return min_unless({_mm256_xor_ps(mask.m, _mm256_castsi256_ps(_mm256_set1_epi32(-1)))}, a, b);
}
inline void copy(Record* to, const Record& from) {
    _mm256_storeu_ps(to->lo, _mm256_loadu_ps(from.lo));
}

#else

struct Box8 {
    Vec4 lo, neg_hi;
};
inline Box8 load_box(const float* p) {
    return {load(p), load(p + 4)};
}
inline void store_box(float* p, Box8 a) {
    store(p, a.lo);
    store(p + 4, a.neg_hi);
}
inline Vec4 low(Box8 a) {
    return a.lo;
}
inline Vec4 neg_high(Box8 a) {
    return a.neg_hi;
}
inline Box8 join(Vec4 lo, Vec4 neg_hi) {
    return {lo, neg_hi};
}
inline Box8 min(Box8 a, Box8 b) {
    return {min(a.lo, b.lo), min(a.neg_hi, b.neg_hi)};
}
inline Box8 operator-(Box8 a, Box8 b) {
    return {a.lo - b.lo, a.neg_hi - b.neg_hi};
}
inline Box8 operator*(Box8 a, Box8 b) {
    return {a.lo * b.lo, a.neg_hi * b.neg_hi};
}
inline Box8 operator+(Box8 a, Box8 b) {
    return {a.lo + b.lo, a.neg_hi + b.neg_hi};
}
inline Box8 all_eight(float x) {
    return {splat(x), splat(x)};
}
inline Box8 load_eight(const float* p) {
    return {load_any(p), load_any(p + 4)};
}
inline void keep_less(Box8 a, Box8 index_a, Box8& b, Box8& index_b) {
    keep_less(a.lo, index_a.lo, b.lo, index_b.lo);
    keep_less(a.neg_hi, index_a.neg_hi, b.neg_hi, index_b.neg_hi);
}
inline Box8 no_box() {
    return {splat(FLT_MAX), splat(FLT_MAX)};
}
inline Box8 centroid2_box(Box8 a) {
    return {a.lo - a.neg_hi, a.neg_hi - a.lo};
}
inline Box8 box_of(const Record& r) {
    return {xyz(load(r.lo)), load(r.neg_hi)};
}
inline Box8 max(Box8 a, Box8 b) {
    return {max(a.lo, b.lo), max(a.neg_hi, b.neg_hi)};
}
inline Box8 highest(Box8 a) {
    alignas(16) float v[4];
    store(v, max(a.lo, a.neg_hi));
    return all_eight(std::max(std::max(v[0], v[1]), std::max(v[2], v[3])));
}
inline Box8 lane_in_all(Box8 a, int lane) {
    alignas(16) float v[4];
    store(v, a.lo);
    return all_eight(v[lane]);
}
inline Box8 less(Box8 a, Box8 b) {
    return {less(a.lo, b.lo), less(a.neg_hi, b.neg_hi)};
}
inline uint32_t first_of(Box8 mask) {
    return any(mask.lo);
}
inline Box8 min_unless(Box8 mask, Box8 a, Box8 b) {
    return min({select(mask.lo, no_box().lo, a.lo), select(mask.neg_hi, no_box().neg_hi, a.neg_hi)}, b);
}
inline Box8 min_where(Box8 mask, Box8 a, Box8 b) {
    return min({select(mask.lo, a.lo, no_box().lo), select(mask.neg_hi, a.neg_hi, no_box().neg_hi)}, b);
}
inline void copy(Record* to, const Record& from) {
    store(to->lo, load(from.lo));
    store(to->neg_hi, load(from.neg_hi));
}

#endif

inline Box8 load_box(const Bounds& b) {
    return load_box(b.lo);
}
inline void store_box(Bounds& b, Box8 a) {
    store_box(b.lo, a);
}
inline Vec4 centroid2(Box8 a) {
    return low(a) - neg_high(a);
}
inline Box8 point(Vec4 p) {
    return join(p, splat(0.0f) - p);
}
// Half the areas of three boxes at once, in lanes 0..2. The arguments are the side lengths; all of them may be negated.
inline Vec4 half_areas_of(Vec4 a, Vec4 b, Vec4 c) {
    Vec4 x, y, z;
    transpose3(a, b, c, x, y, z);
    return x * y + z * (x + y);
}
// NaN or infinite for an empty box.
inline Vec4 half_areas(const AreaScale& area, const Box8 box[3]) {
    return half_areas_of(area.sides(low(box[0]), neg_high(box[0])), area.sides(low(box[1]), neg_high(box[1])),
                         area.sides(low(box[2]), neg_high(box[2])));
}

}  // namespace CLARITY_BVH_ISA
}  // namespace clarity::bvh
