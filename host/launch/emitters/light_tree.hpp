// light_tree.hpp -- a tree over emitters that are somewhere, by which kernels pick one for a point (cl/shading/light_tree.h).
#pragma once
#include <vector>

#include "base/angle.hpp"
#include "rt_types.h"
#include "scene/vec.hpp"

namespace clarity {

// What bounds emitters: where they are, and where they shine to.

// Of an emitter, or of several. Angles in radians.
struct LightBound {
    Vec lower{}, upper{};
    Vec axis{0, 0, 1};
    double spread = kPi;     // normals are within this angle of the axis
    double reach = kPi / 2;  // light goes within this angle of a normal
    bool two_sided = false;
    double intensity = 0;  // mean of the channels, straight on
    rt_u32 emitter = 0;    // if it is one
};

// What bounds both: the box, and a cone of directions (Conty Estevez, Kulla 2018, algorithm 1).
LightBound join(const LightBound& a, const LightBound& b);

// Without intensity.
LightBound bound_of_ball(const Vec& middle, double radius);
// What is flat and has these corners. normal: of the side that shines, of any length.
LightBound bound_of_flat(const Vec* corners, size_t count, const Vec& normal);
// Sets all but the number. The intensity is that of a colour of 1. Returns false for a light that does not fall off with the
// distance.
bool bound_light(const rt_light& light, LightBound& out);

// The nodes, the root first. Returns nothing for no bounds. leaves: those of emitters, in the order of bounds.
std::vector<rt_light_node> build_light_tree(const std::vector<LightBound>& bounds, std::vector<rt_u32>& leaves);

}  // namespace clarity
