// frames.hpp -- fits boxes with axes of their own to triangles.
//
// Tried are the axes of space, those along which the triangles' surface spreads most and least (Gottschalk, Lin, Manocha 1996,
// "OBBTree: A Hierarchical Structure for Rapid Interference Detection"), and, where triangles are few, the planes and longest
// edges of each of them. The box of the least surface is taken, so none has more than the one along the axes of space.
#pragma once
#include "rt_plugin.hpp"

namespace spheres {

class Triangles;

struct Frame {
    float axis[9];  // three vectors of unit length
};
constexpr Frame kFrameOfSpace{{1, 0, 0, 0, 1, 0, 0, 0, 1}};

struct Fit {
    Frame frame;
    float center[3];
    double half[3];  // along the frame's axes
};

double half_surface(const double half[3]);

// The box along a frame. near: a point among the triangles. False if some primitive is no triangle, or the box is not finite.
bool fit_in(const Frame& frame, const Triangles& triangles, const double near[3], Fit& fit);

// The box of the least surface. False if none that was tried has less than `least`, or some primitive is no triangle.
bool fit_frame(const Triangles& triangles, const double near[3], double least, Fit& best);

}  // namespace spheres
