// world_origin.hpp -- when a world lies so far from 0 that floats lose its details, and the origin to subtract then.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "scene/motion/matrix.hpp"
#include "scene/scene.hpp"

namespace clarity::import {

// How many times as far from 0 as it is large a world, or a mesh, has to be: less than 2^-15 of its size is lost up to there.
inline constexpr double kFar = 256;
// The same where files have digits that floats do not hold.
inline constexpr double kFarWithDigits = 16;
// The same where nothing but floats was there, and the shape itself is lost: less than 16 of their steps are as wide as it.
inline constexpr double kFarAsNoShape = 1 << 20;

// Products of two edges of a triangle have to be floats with all their digits. A world that is smaller loses hits.
inline constexpr double kLeastSize = 1e-17;

struct WorldBox {
    Vec lo{INFINITY, INFINITY, INFINITY}, hi{-INFINITY, -INFINITY, -INFINITY};
    void add(const Vec& p) {
        for (int k = 0; k < 3; ++k) lo[k] = std::min(lo[k], p[k]), hi[k] = std::max(hi[k], p[k]);
    }
    void add(const Bounds& b, const Matrix& m);
    double size() const { return std::max({hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]}); }
    double farthest() const;
    bool is_far(double times) const { return size() > 0 && farthest() > times * size(); }
};

// Moves the vertices of an instance's mesh back to their file's coordinates. more: what was subtracted besides its translation.
void add_origin(Scene& scene, const Instance& instance, const std::array<double, 3>& more);

// Of a box that is far. Subtract it in double precision.
Vec origin_of(const WorldBox& box);

}  // namespace clarity::import
