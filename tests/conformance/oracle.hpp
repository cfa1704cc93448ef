// oracle.hpp -- independent answers to rays: Embree for triangles, simple code in double precision for everything else.
#pragma once
#include <memory>
#include <vector>

#include "reference/primitives.hpp"
#include "tools/bench/baselines/embree.hpp"

namespace clarity::test {

class Oracle {
 public:
    explicit Oracle(std::shared_ptr<const Scene> scene);
    ~Oracle();
    Oracle(const Oracle&) = delete;
    Oracle& operator=(const Oracle&) = delete;

    Truth closest(const Ray& ray) const;
    // One answer per pixel, top row first.
    std::vector<Truth> picture(const Camera& camera, int width, int height) const;

    // True if primitive `prim` can be at distance t on the ray, so that naming it is right in a tie between neighbours or
    // duplicates. slack: relative error of t; triangles are widened by 1e-3 of their size.
    bool lies_at(int prim, const Ray& ray, double t, double slack) const;
    // True if rounding of the ray's direction to floats (two units in the last place of 1) can explain t as a hit of the plane
    // of triangle `prim`. Surfaces at grazing angles allow no better answer.
    bool within_rounding(int prim, const Ray& ray, double t) const;
    // The nearest primitive, found by testing all in double precision. Decides where two programs disagree.
    Truth exact(const Ray& ray) const { return primitives_.nearest(ray, 0); }

 private:
    Truth closest_triangle(const Ray& ray) const;

    std::shared_ptr<const Scene> scene_;
    const Primitives primitives_;
    RTCDevice device_ = nullptr;
    RTCScene embree_ = nullptr;
};

}  // namespace clarity::test
