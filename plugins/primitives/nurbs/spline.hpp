// spline.hpp -- a rational spline surface, and its rational Bezier patches.
#pragma once
#include <array>
#include <string>
#include <vector>

namespace nurbs {

inline constexpr int kMaxDegree = 5;  // nurbs.cl has room for as much

using Homogeneous = std::array<double, 4>;  // x w, y w, z w, w

// One direction of the surface.
struct Direction {
    int degree = 3, points = 0;
    std::vector<double> knots;  // points + degree + 1, ascending

    // Fills in knots if there are none: those of a spline that begins and ends at its outer points. Returns what is wrong with
    // them, or nothing. name: "u".
    std::string complete(char name);
};

struct Surface {
    Direction u, v;
    std::vector<Homogeneous> points;  // u.points in a row, v.points rows
};

// A part of the surface as one patch. Its range is a share of the surface's, 0 to 1.
struct Patch {
    std::vector<Homogeneous> points;  // (v.degree + 1) of each of (u.degree + 1) columns
    std::array<double, 2> u, v;
};

// Cuts the surface at its knots, and into smaller patches where it bends, so that few rays need many steps in one.
std::vector<Patch> patches(const Surface& surface);

}  // namespace nurbs
