// world.hpp -- what rays can meet, in double precision and world space.
#pragma once
#include <memory>
#include <vector>

#include "scene/scene.hpp"
#include "vec.hpp"

namespace clarity::reference {

struct Ray {
    Vec origin, direction;  // unit direction
};

struct Hit {
    double t = INFINITY;
    Vec geometric;  // unit normal, on the side that the primitive has it: outwards of closed surfaces
    Vec shading;    // interpolated where the corners have normals; unit, on the same side
    unsigned material = 0;
};

// Triangles are in a tree of boxes, halved by the middle of the longest side; all else is tried one by one.
class World {
 public:
    explicit World(const Scene& scene);
    ~World();
    // The nearest one with 0 < t < limit; false if there is none.
    bool nearest(const Ray& ray, double limit, Hit& hit) const;
    bool blocked(const Ray& ray, double limit) const;
    // How far from a surface at `at` the next ray starts, for it not to meet the same point again.
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
