// touches.hpp -- rays at one part of a shape, and what is known of the surface where they meet it: by differences between
// neighbouring rays, without a word of the shape's own surface function.
#pragma once
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "check/shapes/shape_probe.hpp"
#include "scene/vec.hpp"

namespace clarity::check {

// A unit vector across another one.
Vec across(const Vec& direction);
Vec random_direction(std::mt19937& random);
rt_ray ray_of(const Vec& origin, const Vec& direction, double t_min = 0);
inline Vec point_of(const rt_ray& ray, double t) {
    return to_vec(ray.origin) + t * to_vec(ray.direction);
}

// Whether the answer is a hit, as the host sees it.
inline bool is_hit(const rt_ray& ray, const ProbeHit& hit) {
    return hit.t >= ray.t_min && hit.t < INFINITY;
}

// Rays of all kinds that start beside, in and on the box of a part and go towards it, or near it.
std::vector<rt_ray> rays_at(const ShapeSubject& subject, size_t count, std::mt19937& random);

// A point at which a ray meets a part.
struct Touch {
    rt_ray ray;
    ProbeHit hit;
    Vec at{};
    bool is_second = false;  // behind a nearer hit
    bool is_smooth = false;  // neighbouring rays meet the same sheet of the surface, which is flat at that scale
    Vec across{};            // unit; across the surface, on the ray's side. Of smooth touches
    double cosine = 0;       // of the angle between ray and `across`
};
// Distance between neighbouring rays.
inline double neighbour_distance(const ShapeSubject& subject) {
    return 1e-3 * double(subject.size);
}
// Distance by which two sound tests of one surface may differ.
inline double slack_of(const ShapeSubject& subject) {
    return 1e-4 * double(subject.size) + 1e-6 * double(subject.coordinate);
}
// The first and second points at which the rays meet the part.
std::vector<Touch> touches_of(ShapeProbe& probe, const ShapeSubject& subject, const std::vector<rt_ray>& rays);

}  // namespace clarity::check
