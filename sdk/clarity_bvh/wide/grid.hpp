// grid.hpp -- quantises coordinates to one byte, rounded outwards. For nodes that hold the boxes of their children as bytes on
// a grid of the node (Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs").
#pragma once
#include <cmath>
#include <cstdint>
#include <cstring>

#include "clarity_bvh/base/vec4.hpp"

namespace clarity::bvh {

// How a layout places its planes. The plane of byte q lies at origin + (bias + q) cells, in real numbers. Planes lie at least
// `margin` cells outside of the coordinates that they bound, which covers the rounding of the layout's traversal.
struct GridRule {
    float bias, margin;
    int least_exponent;  // of the smallest cell: its side is 2^exponent
    int most_exponent;   // of the largest cell, for which `bias` cells must stay below FLT_MAX
};

// The grid of one axis of a node. Its cells are powers of two.
class Grid {
 public:
    static constexpr int kPlanes = 255;  // the highest value of a byte

    // The grid of the smallest possible cells that holds the coordinates lo..hi. unbounded() if no cell size fits.
    static Grid around(const GridRule& rule, float lo, float hi);
    // The grid of a packed node.
    Grid(const GridRule& rule, float origin, int exponent)
        : origin_(origin),
          exponent_(exponent),
          margin_(double{rule.margin}),
          cell_(power_of_two(exponent)),
          per_cell_(power_of_two(-exponent)),
          base_(origin + rule.bias * cell_) {}

    // True if the axis is so long, or so far away, that no grid holds it. The origin is then NaN.
    bool unbounded() const { return std::isnan(origin_); }
    float origin() const { return origin_; }
    int exponent() const { return exponent_; }
    // The bytes of planes that bound a coordinate from below and from above. The coordinate must be within the grid.
    int lower(float plane) const { return static_cast<int>((plane - base_) * per_cell_ - margin_); }
    int upper(float plane) const {
        const double at = (plane - base_) * per_cell_ + margin_;
        return static_cast<int>(at) + (static_cast<int>(at) < at);
    }
    // The bytes of four coordinates.
    void lower_four(Vec4 planes, int* bytes) const {
#ifdef CLARITY_BVH_SSE2
        const auto two = [&](__m128 p) { return _mm_cvttpd_epi32(_mm_sub_pd(cells(p), both(margin_))); };
        store_four(bytes, two(planes.m), two(_mm_movehl_ps(planes.m, planes.m)));
#else
        for (int i = 0; i < 4; ++i) bytes[i] = lower(planes.v[i]);
#endif
    }
    void upper_four(Vec4 planes, int* bytes) const {
#ifdef CLARITY_BVH_SSE2
        const auto two = [&](__m128 p) {
            const __m128d at = _mm_add_pd(cells(p), both(margin_));
            const __m128i whole = _mm_cvttpd_epi32(at);
            // A lane of the comparison is -1 if there is a rest.
            const __m128d rest = _mm_cmplt_pd(_mm_cvtepi32_pd(whole), at);
            return _mm_sub_epi32(whole, _mm_shuffle_epi32(_mm_castpd_si128(rest), _MM_SHUFFLE(3, 3, 2, 0)));
        };
        store_four(bytes, two(planes.m), two(_mm_movehl_ps(planes.m, planes.m)));
#else
        for (int i = 0; i < 4; ++i) bytes[i] = upper(planes.v[i]);
#endif
    }
    // The coordinate of a byte, in double precision: its rounding error is far below any sensible margin.
    double plane(uint32_t byte) const { return base_ + cell_ * byte; }

 private:
#ifdef CLARITY_BVH_SSE2
    static __m128d both(double x) { return _mm_set1_pd(x); }
    static void store_four(int* p, __m128i a, __m128i b) {
        _mm_storeu_si128(reinterpret_cast<__m128i*>(p), _mm_unpacklo_epi64(a, b));
    }
    // Two coordinates in cells from byte 0 on.
    __m128d cells(__m128 two) const { return _mm_mul_pd(_mm_sub_pd(_mm_cvtps_pd(two), both(base_)), both(per_cell_)); }
#endif
    // 2^exponent, for exponents of normal numbers. std::ldexp() takes ten times as long.
    static double power_of_two(int exponent) {
        const uint64_t bits = static_cast<uint64_t>(exponent + 1023) << 52;
        double power;
        std::memcpy(&power, &bits, sizeof power);
        return power;
    }

    float origin_;
    int exponent_;
    double margin_, cell_, per_cell_, base_;  // base_: coordinate of byte 0
};

}  // namespace clarity::bvh
