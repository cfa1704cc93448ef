// curve.hpp -- from a primitive's box to its place on a space-filling curve.
#pragma once
#include "range.hpp"
#include "rt_plugin.h"

namespace bvh2 {

// The box of a primitive. A bound that is no number becomes the farthest one (MINPS and MAXPS give their second operand), and
// bounds in the wrong order are put right: whatever comes in, the box is sound and nothing is lost.
inline void sound_box(const rt_prim& prim, Vec4& lo, Vec4& neg_hi) {
    const Vec4 least = splat(-FLT_MAX), most = splat(FLT_MAX);
    const Vec4 a = min(max(xyz(load_any(prim.lo)), least), most), b = max(min(xyz(load_any(prim.hi)), most), least);
    lo = min(a, b);
    neg_hi = splat(0.0f) - max(a, b);
}

// Half the centroid: differences of two are numbers, however large the coordinates.
inline Vec4 half_centroid(Vec4 lo, Vec4 neg_hi) {
    const Vec4 quarter = splat(0.25f);
    return lo * quarter - neg_hi * quarter;
}

// Each bit of a place says in which half of its cell a centroid lies, the halves being those of the axis along which the cell
// is longest (Vinkler, Bittner, Havran 2017, "Extended Morton Codes for High Performance Bounding Volume Hierarchy
// Construction"). Against x, y, z by turns the trees of the suite `cpu` cost 3 % less by the heuristic; lucy's 11 % less.
class Curve {
 public:
    static constexpr unsigned kMaxBits = 36;

    // For so many primitives, whose half centroids have these bounds.
    Curve(const Bounds& half_centroids, uint32_t primitive_count) : base_(xyz(load(half_centroids.lo))) {
        alignas(16) float extent[4], scale[4] = {}, last[4] = {};
        store(extent, splat(0.0f) - (base_ + xyz(load(half_centroids.neg_hi))));
        // Cells are about four times finer than primitives spread over a surface; finer ones gained nothing, and are sorted in
        // more passes.
        bits_ = std::min(kMaxBits, 3 * (kFiner + (log2_ceil(primitive_count) + 1) / 2));
        uint64_t value[3][kAxisBits];
        unsigned count[3] = {};
        float side[3] = {extent[0], extent[1], extent[2]};
        for (unsigned bit = bits_; bit-- > 0;) {
            int axis = -1;
            for (int a = 0; a < 3; ++a)
                if (count[a] < kAxisBits && (axis < 0 || side[a] > side[axis])) axis = a;
            side[axis] *= 0.5f;
            value[axis][count[axis]++] = uint64_t{1} << bit;
        }
        for (int a = 0; a < 3; ++a) {
            const auto cells = static_cast<float>(1u << count[a]);
            scale[a] = std::min(cells / extent[a], FLT_MAX);  // no extent: all in cell 0
            last[a] = cells - 1;
            low_[a][0] = high_[a][0] = 0;
            for (unsigned bit = 0; bit < count[a]; ++bit) {
                uint64_t* const table = bit < kLowBits ? low_[a] : high_[a];
                const uint32_t half = 1u << bit % kLowBits;
                for (uint32_t i = 0; i < half; ++i) table[half + i] = table[i] | value[a][count[a] - 1 - bit];
            }
        }
        scale_ = load(scale);
        last_ = load(last);
    }

    // Below 2^bits().
    uint64_t place(Vec4 half_centroid) const {
        uint32_t cell[3];
        to_index(max(min((half_centroid - base_) * scale_, last_), splat(0.0f)), cell);
        return on_axis(0, cell[0]) | on_axis(1, cell[1]) | on_axis(2, cell[2]);
    }
    unsigned bits() const { return bits_; }

 private:
    static constexpr unsigned kAxisBits = 15, kLowBits = 8, kFiner = 2;

    uint64_t on_axis(int a, uint32_t cell) const { return low_[a][cell % (1u << kLowBits)] | high_[a][cell >> kLowBits]; }

    Vec4 base_, scale_, last_;
    unsigned bits_;
    uint64_t low_[3][1u << kLowBits], high_[3][1u << (kAxisBits - kLowBits)];  // bits of a place by bits of a cell's number
};

}  // namespace bvh2
