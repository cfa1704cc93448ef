// rt_cost.hpp -- what a structure costs a ray by the surface area heuristic, by one measure for all structures.
//
// Of the lines that meet a convex volume, a convex one within it meets the share of their surfaces (Goldsmith, Salmon 1987,
// "Automatic Creation of Object Hierarchies for Ray Tracing"). So a ray that meets the box around a group's primitives, and
// that no hit stops, in mean
//   visits `sah_nodes` nodes: the surfaces of all inner nodes, or of all cells of a grid, in sum, over that of the box;
//   tests `sah_primitives` primitives: the same of the leaves, each times the number of its primitives.
// Of several groups it is the mean, weighted by their numbers of primitives; an instance counts as a primitive. A node is one
// visit, however many children it has. Volumes that reach beyond the box are taken for no larger than it.
// A builder's own `sah_cost`, where it has one, weighs the two: traversal_cost * sah_nodes + intersection_cost *
// sah_primitives.
#pragma once
#include <algorithm>

#include "rt_plugin.hpp"

namespace rt {

inline double surface_of(const float lo[3], const float hi[3]) {
    const double x = double{hi[0]} - lo[0], y = double{hi[1]} - lo[1], z = double{hi[2]} - lo[2];
    return 2 * (x * y + y * z + z * x);
}
// Of a box as six numbers, the lower corner first.
inline double surface_of(const float box[6]) {
    return surface_of(box, box + 3);
}

// Sums over nodes of one group.
struct Surfaces {
    double nodes = 0, primitives = 0;
    void add_node(double surface) { nodes += surface; }
    void add_leaf(double surface, double count) { primitives += surface * count; }
    void add(const Surfaces& more) {
        nodes += more.nodes;
        primitives += more.primitives;
    }
};

class ExpectedCost {
 public:
    // A group of `count` primitives. `box`: the surface of the box around them. No ray hits one of a point or a line.
    void add_group(double count, double box, const Surfaces& sums) {
        if (!(box > 0)) return;
        nodes_ += count * (sums.nodes / box);
        primitives_ += count * (sums.primitives / box);
        count_ += count;
    }
    double nodes() const { return count_ > 0 ? nodes_ / count_ : 0; }
    double primitives() const { return count_ > 0 ? primitives_ / count_ : 0; }
    double weighted(double node, double primitive) const { return node * nodes() + primitive * primitives(); }
    void report(const rt_build_output* out) const {
        stat(out, "sah_nodes", nodes());
        stat(out, "sah_primitives", primitives());
    }

 private:
    double nodes_ = 0, primitives_ = 0, count_ = 0;
};

}  // namespace rt
