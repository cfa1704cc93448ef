// oracle.hpp -- what rays hit by the word of others: Embree for triangles, plain double precision for everything else.
#pragma once
#include <embree3/rtcore.h>

#include <array>
#include <cmath>
#include <vector>

#include "render/frame/renderer.hpp"

namespace clarity::test {

struct Truth {
    double t = INFINITY;
    int prim = -1;  // numbered as the renderer numbers: triangles of all instances, spheres, polygons, planes
    bool hit() const { return std::isfinite(t); }
};

struct Ray {
    std::array<double, 3> origin{}, direction{};
    double t_min = 0, t_max = INFINITY;
};
Ray widened(const rt_ray& ray);

// The ray through the centre of pixel (x, y), y = 0 at the top, in double precision.
Ray camera_ray(const Camera& camera, int width, int height, int x, int y);

// World-space corners of every placed triangle, in the order of `prim`.
std::vector<float> world_corners(const Scene& scene);

class Oracle {
 public:
    explicit Oracle(std::shared_ptr<const Scene> scene);
    ~Oracle();
    Oracle(const Oracle&) = delete;
    Oracle& operator=(const Oracle&) = delete;

    Truth closest(const Ray& ray) const;
    // One a pixel, top row first.
    std::vector<Truth> picture(const Camera& camera, int width, int height) const;

    // Whether primitive `prim` may be said to lie at distance t on the ray: for the ties between neighbours and duplicates.
    // slack: of t, relative; triangles are widened by 1e-3 of their size.
    bool lies_at(int prim, const Ray& ray, double t, double slack) const;
    // Whether the plane of triangle `prim` is met at t by a ray that differs from this one by the rounding of its direction to
    // floats (two units in the last place of 1): true for surfaces seen so flatly that no better answer can be had.
    bool within_rounding(int prim, const Ray& ray, double t) const;
    // Distance of the nearest triangle by trying all in double precision, for the cases where two programs disagree.
    Truth exact(const Ray& ray) const;

 private:
    Truth closest_triangle(const Ray& ray) const;
    void closest_analytic(const Ray& ray, Truth& best) const;
    double hit_sphere(size_t i, const Ray& ray) const;
    double hit_polygon(size_t i, const Ray& ray) const;
    double hit_plane(size_t i, const Ray& ray) const;

    std::shared_ptr<const Scene> scene_;
    std::vector<float> corners_;  // 9 a triangle
    int triangle_count_ = 0;
    RTCDevice device_ = nullptr;
    RTCScene embree_ = nullptr;
};

}  // namespace clarity::test
