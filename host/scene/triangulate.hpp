// triangulate.hpp -- cuts faces with any number of corners into triangles.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "rt_types.h"

namespace clarity {

// Cuts a face of n corners into n - 2 triangles, also if the face crosses itself or has no area.
//
// A flat convex face becomes a fan from its first corner (the order of `prim` is defined by this). A bent or concave quad is
// cut along its shorter diagonal. Any other face is cut by ear clipping in the plane of its Newell normal (Meisters 1975,
// "Polygons have ears"); small faces lose the ear of the best shape first. The surface of a bent face depends on the cut; these
// cuts are the ones that FBX readers make.
//
// Reflex corners lie in a grid, so that a face of 100 000 corners takes about as long as reading it. The object keeps its
// scratch memory from face to face: use one per import.
class Triangulator {
 public:
    // Appends the triangles of a face to `out`, three entries of `corners` each. positions: 3 floats per vertex.
    void add(const float* positions, const rt_u32* corners, rt_u32 corner_count, std::vector<rt_u32>& out);

    // Number of faces of which the rest became a plain fan because ear clipping would have taken too long. Triangles may
    // overlap there.
    uint64_t given_up() const { return given_up_; }

 private:
    using Point = std::array<double, 2>;
    bool project(const float* positions, const rt_u32* corners, rt_u32 count);
    bool is_convex() const;
    bool fan_is_flat(const float* positions, const rt_u32* corners, rt_u32 count) const;
    double turn(rt_u32 a, rt_u32 b, rt_u32 c) const;  // twice the signed area of the triangle
    bool is_reflex(rt_u32 corner) const;
    void build_grid();
    bool is_ear(rt_u32 corner, int leniency);
    double shape(rt_u32 corner) const;
    rt_u32 best_ear(rt_u32 at, rt_u32 left);
    void clip_ears(const rt_u32* corners, std::vector<rt_u32>& out);

    std::vector<Point> points_;
    double tolerance_ = 0;  // rounding error of a turn, relative to the product of its edge lengths
    double rounding_ = 0;   // rounding error of a coordinate, as a length
    std::vector<rt_u32> prev_, next_;
    std::vector<uint8_t> reflex_;
    // The reflex corners of grid cell i are cell_items_[cell_first_[i] .. cell_first_[i + 1]).
    std::vector<rt_u32> cell_first_, cell_items_;
    Point grid_min_{}, cells_per_unit_{};
    rt_u32 grid_size_ = 0;
    uint64_t budget_ = 400000000;  // point tests left for large faces during the life of this object: about two seconds
    uint64_t given_up_ = 0;
};

}  // namespace clarity
