// touches.hpp -- rays at one part of a shape, and what is known of the surface where they meet it: by differences between
// neighbouring rays, without a word of the shape's own surface function.
#pragma once
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "check/shapes/shape_probe.hpp"

namespace clarity::check {

using Vec3 = std::array<double, 3>;
inline Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vec3 operator*(double s, const Vec3& a) {
    return {s * a[0], s * a[1], s * a[2]};
}
inline double dot(const Vec3& a, const Vec3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Vec3& a) {
    return std::sqrt(dot(a, a));
}
inline Vec3 unit(const Vec3& a) {
    return (1 / length(a)) * a;
}
inline Vec3 vec3(const float* p) {
    return {p[0], p[1], p[2]};
}
// A unit vector across another one.
Vec3 across(const Vec3& direction);
Vec3 random_direction(std::mt19937& random);
rt_ray ray_of(const Vec3& origin, const Vec3& direction, double t_min = 0);
inline Vec3 point_of(const rt_ray& ray, double t) {
    return vec3(ray.origin) + t * vec3(ray.direction);
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
    Vec3 at{};
    bool is_second = false;  // behind a nearer hit
    bool is_smooth = false;  // neighbouring rays meet the same sheet of the surface, which is flat at that scale
    Vec3 across{};           // unit; across the surface, on the ray's side. Of smooth touches
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
