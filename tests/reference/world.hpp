// world.hpp -- the surfaces that rays hit, in double precision and world space.
#pragma once
#include <memory>
#include <vector>

#include "reference/primitives.hpp"

namespace clarity::reference {

using test::Ray;

struct Hit {
    double t = INFINITY;
    Vec geometric{};           // unit normal, on the side that the primitive defines: outside of closed surfaces
    Vec shading{};             // interpolated if the corners have normals; unit length, on the same side
    Vec along_u{}, along_v{};  // how the place changes with the coordinates of textures; 0 if there are none
    unsigned material = 0;
};

// Triangles are in a tree of boxes, each divided in two halves along its longest side. All other primitives are tested one by
// one.
class World {
 public:
    explicit World(const Scene& scene);
    ~World();
    // Finds the nearest hit within the ray's limits; returns false if there is none.
    bool nearest(const Ray& ray, Hit& hit) const;
    bool blocked(const Ray& ray) const { return nearest(ray).hit(); }
    // Distance from the surface at which the next ray starts, so that it does not hit the same point again.
    double offset(const Vec& at) const;

 private:
    struct Triangle;
    struct Node;
    void add_instance(const Instance& instance);
    unsigned build(unsigned first, unsigned end);
    test::Truth nearest(const Ray& ray) const;

    const Scene& scene_;
    const test::Primitives primitives_;
    std::vector<Triangle> triangles_;  // in the order of Truth::prim
    std::vector<int> order_;           // of the triangles with an area, in the order of the tree
    std::vector<Node> nodes_;
};

}  // namespace clarity::reference
