// brute_force.hpp -- what rays hit, computed on the host in double precision by testing every primitive. The reference for
// hits.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "rt_types.h"
#include "scene/vec.hpp"
#include "structures/accel_build.hpp"

namespace clarity::check {

// Of a distance: part of Contact::t_error.
constexpr double kRelativeError = 1e-5;

// A primitive that a ray meets, or passes so closely that rounding decides.
struct Contact {
    rt_i32 prim = -1;      // its number, as hits report it
    rt_i32 instance = -1;  // number in BuildScene::instances; -1: none
    rt_u32 ref = 0;
    double t = 0;
    double t_error = 0;    // by which a sound answer may differ
    bool certain = false;  // a sound structure cannot miss it, or one of the triangles around it
    double latest = 0;     // if it is certain: a sound structure has hit it, or one of these, before
};

// All primitives that one ray may hit between t_min and t_max, the nearest first.
struct Truth {
    std::vector<Contact> contacts;
    const Contact* nearest_certain() const;
    // No sound answer is farther; infinity: none is certain.
    double latest() const;
};

// Around a triangle. Most are far from a ray, which this shows with less arithmetic.
struct Ball {
    Vec middle;
    double reach, largest;  // its radius; the largest coordinate of `middle`
};

// For finite rays with a direction. Keeps a reference to the scene, whose prims and triangles must be there. Thread-safe.
class BruteForce {
 public:
    explicit BruteForce(const BuildScene& scene);
    Truth trace(const rt_ray& ray) const;
    std::vector<Truth> trace(const std::vector<rt_ray>& rays) const;  // on all threads

 private:
    const BuildScene& scene_;
    std::vector<Ball> balls_;  // of its triangles
};

}  // namespace clarity::check
