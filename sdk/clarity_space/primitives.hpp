// primitives.hpp -- what builders that part space ask of primitives: grids, octrees. Header only, part of the SDK.
#pragma once
#include <algorithm>
#include <cmath>

#include "rt_plugin.hpp"

namespace clarity::space {

constexpr double kEps = 1.0 / (1 << 24);  // RT_EPS of kernels

// Whether a primitive is too large for cells: 1e15 or more, not finite, or not a number. A huge sphere's box may be infinite.
inline bool is_huge(const rt_prim& p) {
    for (int k = 0; k < 3; ++k)
        if (!(std::fabs(p.lo[k]) < 1e15f && std::fabs(p.hi[k]) < 1e15f)) return true;
    return false;
}

// The plane of a triangle, widened by the rounding of the kernels' own normal.
class TrianglePlane {
 public:
    explicit TrianglePlane(const rt_packed_prim& t) {
        double e[2][3], longest[2] = {0, 0};
        for (int k = 0; k < 3; ++k) {
            e[0][k] = double{t.b[k]} - t.a[k], e[1][k] = double{t.c[k]} - t.a[k];
            for (int i = 0; i < 2; ++i) longest[i] = std::max(longest[i], std::fabs(e[i][k]));
        }
        for (int k = 0; k < 3; ++k) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            normal_[k] = e[0][i] * e[1][j] - e[0][j] * e[1][i];
            offset_ += normal_[k] * t.a[k];
        }
        slack_ = 16 * kEps * longest[0] * longest[1] * std::max(longest[0], longest[1]);
    }
    double normal(int axis) const { return normal_[axis]; }
    // How far a point is above it, times the length of the normal; and how far the centre of a box is if the plane may pass
    // through it. half: half of the box's size.
    double height(const double point[3]) const {
        return normal_[0] * point[0] + normal_[1] * point[1] + normal_[2] * point[2] - offset_;
    }
    double reach(const double half[3]) const {
        return slack_ + std::fabs(normal_[0]) * half[0] + std::fabs(normal_[1]) * half[1] + std::fabs(normal_[2]) * half[2];
    }
    // Whether it passes a box of this centre and half of this size.
    bool meets(const double center[3], const double half[3]) const { return !(std::fabs(height(center)) > reach(half)); }

 private:
    double normal_[3], offset_ = 0, slack_;
};

}  // namespace clarity::space
