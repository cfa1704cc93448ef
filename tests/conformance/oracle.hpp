// oracle.hpp -- independent answers to rays: Embree for triangles, simple code in double precision for everything else.
#pragma once
#include <embree3/rtcore.h>
#include <memory>

#include <array>
#include <cmath>
#include <vector>

#include "scene/scene.hpp"

namespace clarity::test {

// The nearest hit of a ray.
struct Truth {
    double t = INFINITY;
    int prim = -1;  // numbered as by the renderer: triangles of all instances, spheres, polygons, planes; -1: no hit
    bool hit() const { return std::isfinite(t); }
};

struct Ray {
    std::array<double, 3> origin{}, direction{};
    double t_min = 0, t_max = INFINITY;
};
Ray widened(const rt_ray& ray);

// The ray through the centre of pixel (x, y), in double precision; y = 0 is the top row.
Ray camera_ray(const Camera& camera, int width, int height, int x, int y);

// World-space corners of all placed triangles, in the order of `prim`.
std::vector<float> world_corners(const Scene& scene);

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
    // The nearest triangle, found by testing all in double precision. Decides where two programs disagree.
    Truth exact(const Ray& ray) const;

 private:
    Truth closest_triangle(const Ray& ray) const;
    void closest_analytic(const Ray& ray, Truth& best) const;
    double hit_sphere(size_t i, const Ray& ray) const;
    double hit_polygon(size_t i, const Ray& ray) const;
    double hit_plane(size_t i, const Ray& ray) const;

    std::shared_ptr<const Scene> scene_;
    std::vector<float> corners_;  // 9 floats per triangle
    int triangle_count_ = 0;
    RTCDevice device_ = nullptr;
    RTCScene embree_ = nullptr;
};

}  // namespace clarity::test
