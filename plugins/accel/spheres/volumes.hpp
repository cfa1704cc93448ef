// volumes.hpp -- the volumes that a node may have: a sphere, a box, or a box with axes of its own.
//
// The sphere encloses the box: same centre, radius half the diagonal. An oriented box is fitted to the corners of triangles
// in several frames, and the box with the least surface is kept. Nodes with other primitives keep the axes of space.
#pragma once
#include "rt_plugin.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "spheres_types.h"

namespace spheres {

struct Box {
    float lo[3], hi[3];
    Box();
    void add(const Box& other);
    int longest_axis() const;
    float center(int axis) const { return 0.5f * lo[axis] + 0.5f * hi[axis]; }
};

// Half the extent of a leaf that every ray enters. It is finite, so that the ray test computes no NaN.
constexpr float kEverywhere = 1e30f;

class Triangles;

// Writes the volumes of nodes.
class Volumes {
 public:
    // axes: one for each node, or nullptr if they are not oriented.
    Volumes(rt_u32 kind, spheres_node* nodes, spheres_axes* axes) : kind_(kind), nodes_(nodes), axes_(axes) {}

    // Encloses the box.
    void enclose(rt_u32 at, const Box& box) const;
    // Encloses a box of triangles as tightly as the kind allows.
    void fit(rt_u32 at, const Box& box, const Triangles& triangles) const;
    // The same with the axes that the node has. Only for turned nodes; others need no triangles, but enclose().
    void refit(rt_u32 at, const Box& box, const Triangles& triangles) const;
    void fill_space(rt_u32 at) const;

    bool is_oriented() const { return kind_ == SPHERES_ORIENTED; }
    bool is_everywhere(rt_u32 at) const { return nodes_[at].volume[3] >= kEverywhere; }
    // Whether the node's axes are not those of space.
    bool is_turned(rt_u32 at) const;
    double surface(rt_u32 at) const;
    // A length of the order of the volume's size.
    float size(rt_u32 at) const;

 private:
    const rt_u32 kind_;
    spheres_node* const nodes_;
    spheres_axes* const axes_;
};

// Some triangles. Not all primitives need be triangles: those that are none are nullptr.
class Triangles {
 public:
    virtual rt_u32 count() const = 0;
    virtual const rt_packed_prim* operator[](rt_u32 i) const = 0;

 protected:
    ~Triangles() = default;
};

// Fits boxes with axes of their own to triangles.
//
// Tried are the axes of space, those along which the triangles' surface spreads most and least (Gottschalk, Lin, Manocha 1996,
// "OBBTree: A Hierarchical Structure for Rapid Interference Detection"), and, where triangles are few, the planes and longest
// edges of each of them. The box of the least surface is taken, so none has more than the one along the axes of space.
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
