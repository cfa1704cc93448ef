// cell.hpp -- the convex part of space that belongs to a node.
#pragma once
#include <array>
#include <vector>

#include "rt_plugin.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bsp_types.h"

namespace bsp {

struct Box {
    float lo[3], hi[3];
};

using Point = std::array<double, 3>;

// n . p of direction k.
inline double along(rt_u32 k, const Point& p) {
    return BSP_COMPONENT(BSP_XS, k) * double(p[0]) + BSP_COMPONENT(BSP_YS, k) * p[1] + BSP_COMPONENT(BSP_ZS, k) * p[2];
}

// The surface of the parts of a cell below and above planes of one direction, at equal distances.
struct Profile {
    static constexpr int kSteps = 8;  // the first plane touches the cell, and so does the last
    double low = 0, high = 0;         // n . p of these
    double below[kSteps + 1], above[kSteps + 1];
    // Of a plane in between.
    double part(const double (&of)[kSteps + 1], double at) const;
};

class Cell {
 public:
    explicit Cell(const Box& box);
    // The part below (side 0) or above the plane n . p = at of direction k. Where that is nothing, the cell is empty.
    Cell half(rt_u32 k, double at, int side) const;
    double surface() const { return surface_; }
    Profile profile(rt_u32 k) const;
    // The bounds; rounded outwards. Not of an empty cell.
    Box box() const;
    bool empty() const { return starts_.size() < 2; }

 private:
    Cell() = default;
    void end_face();

    // The corners of face f are corners_[starts_[f]] to corners_[starts_[f + 1] - 1], one way round seen from outside.
    std::vector<Point> corners_;
    std::vector<rt_u32> starts_{0};
    double surface_ = 0;
};

}  // namespace bsp
