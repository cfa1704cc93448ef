#include "clarity_bvh/kernels/kernels.hpp"

#include "clarity_bvh/kernels/kernels.inl"

namespace clarity::bvh {

const Kernels& kernels() {
#ifdef CLARITY_BVH_AVX2
    static const bool has_avx2 = __builtin_cpu_supports("avx2");
    if (has_avx2) return avx2::kernels;
#endif
    return generic::kernels;
}

void bound(const Record* first, const Record* end, Bounds& box, Bounds& centroids2) {
    for (const Record* r = first; r != end; ++r) {
        const Vec4 lo = xyz(load(r->lo)), neg_hi = load(r->neg_hi), centroid2 = lo - neg_hi;
        store(box.lo, min(load(box.lo), lo));
        store(box.neg_hi, min(load(box.neg_hi), neg_hi));
        store(centroids2.lo, min(load(centroids2.lo), centroid2));
        store(centroids2.neg_hi, min(load(centroids2.neg_hi), splat(0.0f) - centroid2));
    }
}

void halve(Record* records, const Range& range, Range& left, Range& right) {
    Bounds box, centroids2;
    bound(records + range.begin, records + range.end, box, centroids2);
    int axis = 0;
    float longest = 0.0f;
    for (int a = 0; a < 3; ++a) {
        const float extent = 0.5f * centroids2.hi(a) - 0.5f * centroids2.lo[a];
        if (extent > longest) {
            longest = extent;
            axis = a;
        }
    }
    const uint32_t middle = range.begin + range.count() / 2;
    if (longest > 0.0f)  // else all centroids are equal, and any halves will do
        std::nth_element(records + range.begin, records + middle, records + range.end,
                         [axis](const Record& a, const Record& b) {
                             return 0.5f * a.lo[axis] - 0.5f * a.neg_hi[axis] < 0.5f * b.lo[axis] - 0.5f * b.neg_hi[axis];
                         });
    left.begin = range.begin;
    left.end = right.begin = middle;
    right.end = range.end;
    left.buffer = right.buffer = range.buffer;
    left.depth = right.depth = range.depth + 1;
    left.box = right.box = left.centroids2 = right.centroids2 = Bounds{};
    bound(records + left.begin, records + left.end, left.box, left.centroids2);
    bound(records + right.begin, records + right.end, right.box, right.centroids2);
}

}  // namespace clarity::bvh
