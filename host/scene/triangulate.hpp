// triangulate.hpp -- faces of any number of corners into triangles.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "rt_types.h"

namespace clarity {

// A flat convex face becomes a fan from its first corner (so is the order of `prim` defined). A bent or concave quad is cut
// along its shorter diagonal, any other face by ear clipping in the plane of its Newell normal (Meisters 1975, "Polygons have
// ears"), small ones best-shaped ear first: where a face is bent the surface depends on the cut, and these cuts are what FBX
// readers make. Reflex corners lie in a grid, so that a face of 100 000 corners takes about as long as it takes to read. Always
// n - 2 triangles, also where a face crosses itself or has no area. Keeps its scratch memory from face to face; one object per
// import.
class Triangulator {
 public:
    // Appends the triangles of a face to `out`, three entries of `corners` each. positions: 3 floats per vertex.
    void add(const float* positions, const rt_u32* corners, rt_u32 corner_count, std::vector<rt_u32>& out);

    // Faces of which a part became a plain fan because cutting ears would have taken too long; overlaps are possible there.
    uint64_t given_up() const { return given_up_; }

 private:
    using Point = std::array<double, 2>;
    bool project(const float* positions, const rt_u32* corners, rt_u32 count);
    bool is_convex() const;
    bool fan_is_flat(const float* positions, const rt_u32* corners, rt_u32 count) const;
    double turn(rt_u32 a, rt_u32 b, rt_u32 c) const;  // twice the signed area
    bool is_reflex(rt_u32 corner) const;
    void build_grid();
    bool is_ear(rt_u32 corner, int leniency);
    double shape(rt_u32 corner) const;
    rt_u32 best_ear(rt_u32 at, rt_u32 left);
    void clip_ears(const rt_u32* corners, std::vector<rt_u32>& out);

    std::vector<Point> points_;
    double tolerance_ = 0;  // of a turn, relative to the product of its edges: rounding of the positions
    double rounding_ = 0;   // absolute, length: of a coordinate
    std::vector<rt_u32> prev_, next_;
    std::vector<uint8_t> reflex_;
    // Reflex corners by cell, as ranges of cell_items_.
    std::vector<rt_u32> cell_first_, cell_items_;
    Point grid_min_{}, cells_per_unit_{};
    rt_u32 grid_size_ = 0;
    uint64_t budget_ = 400000000;  // point tests for large faces in the life of an object: about two seconds
    uint64_t given_up_ = 0;
};

}  // namespace clarity
