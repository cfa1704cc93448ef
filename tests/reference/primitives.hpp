// primitives.hpp -- rays, and where they hit the primitives of a scene: formulas in double precision that share no line with
// the kernels. All tests that need a true answer to a ray take it from here.
#pragma once
#include <vector>

#include "rt_plugin.h"
#include "scene/scene.hpp"
#include "scene/vec.hpp"

namespace clarity::test {

struct Ray {
    Vec origin{}, direction{};
    double t_min = 0, t_max = INFINITY;
    Vec at(double t) const { return origin + t * direction; }
};
Ray widened(const rt_ray& ray);

// The ray through the centre of pixel (x, y), with a direction of unit length; y = 0 is the top row.
Ray camera_ray(const Camera& camera, int width, int height, int x, int y);

// Distance to a sphere along the ray; infinity: it is missed. margin: distance of the ray's line from the silhouette, in radii.
double hit_sphere(const Vec& center, double radius, const Ray& ray, double* margin = nullptr);

// Snell's and Fresnel's laws for unpolarised light. eta: index on this side / index on the other side. fresnel() returns 1 for
// total internal reflection.
double fresnel(double cos_in, double eta);
Vec refracted(const Vec& direction, const Vec& normal_towards, double eta);

// The nearest hit of a ray.
struct Truth {
    double t = INFINITY;
    int prim = -1;  // numbered as by the renderer: triangles of all instances, spheres, polygons, planes; -1: no hit
    bool hit() const { return std::isfinite(t); }
};

// World-space corners of all placed triangles, in the order of `prim`.
std::vector<float> world_corners(const Scene& scene);
// Distance to a triangle of nine floats that is widened by `slack`, relative to its size; infinity: it is missed. weights: of
// the second and the third corner.
double hit_triangle(const float* corners, const Ray& ray, double slack, double weights[2] = nullptr);

// The primitives of a scene, tested one by one. Keeps a reference to the scene.
class Primitives {
 public:
    explicit Primitives(const Scene& scene);
    int triangle_count() const { return triangle_count_; }
    const float* corners(int triangle) const { return &corners_[9 * size_t(triangle)]; }
    Vec polygon_normal(const Polygon& polygon) const;  // not of unit length

    // Distance to one primitive; infinity: it is missed. Triangles are widened by `slack`.
    double distance(int prim, const Ray& ray, double slack) const;
    // The nearest of the primitives numbered from `first` on.
    Truth nearest(const Ray& ray, int first) const;

 private:
    double hit_polygon(const Polygon& polygon, const Ray& ray) const;

    const Scene& scene_;
    const PrimNumbers numbers_;
    std::vector<float> corners_;  // 9 floats per triangle
    int triangle_count_;
};

}  // namespace clarity::test
