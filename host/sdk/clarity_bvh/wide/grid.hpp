// grid.hpp -- quantises coordinates to one byte, rounded outwards. For nodes that hold the boxes of their children as bytes on
// a grid of the node (Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs").
#pragma once
#include <cmath>
#include <cstdint>

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
          cell_(std::ldexp(1.0, exponent)),
          per_cell_(std::ldexp(1.0, -exponent)),
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
    // The coordinate of a byte, in double precision: its rounding error is far below any sensible margin.
    double plane(uint32_t byte) const { return base_ + cell_ * byte; }

 private:
    float origin_;
    int exponent_;
    double margin_, cell_, per_cell_, base_;  // base_: coordinate of byte 0
};

}  // namespace clarity::bvh
