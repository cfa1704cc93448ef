// world.hpp -- everything that rays can hit, in double precision and world space.
#pragma once
#include <memory>
#include <vector>

#include "scene/scene.hpp"
#include "vec.hpp"

namespace clarity::reference {

struct Ray {
    Vec origin, direction;  // direction has unit length
};

struct Hit {
    double t = INFINITY;
    Vec geometric;  // unit normal, on the side that the primitive defines: outside of closed surfaces
    Vec shading;    // interpolated if the corners have normals; unit length, on the same side
    unsigned material = 0;
};

// Triangles are in a tree of boxes, each divided at the middle of its longest side. All other primitives are tested one by one.
class World {
 public:
    explicit World(const Scene& scene);
    ~World();
    // Finds the nearest hit with 0 < t < limit; returns false if there is none.
    bool nearest(const Ray& ray, double limit, Hit& hit) const;
    bool blocked(const Ray& ray, double limit) const;
    // Distance from the surface at which the next ray starts, so that it does not hit the same point again.
    double offset(Vec at) const;

 private:
    struct Triangle;
    struct Node;
    void add_instance(const Scene& scene, const Instance& instance);
    unsigned build(unsigned first, unsigned end);
    void try_triangles(const Ray& ray, Hit& hit) const;

    const Scene& scene_;
    std::vector<Triangle> triangles_;
    std::vector<Node> nodes_;
};

}  // namespace clarity::reference
