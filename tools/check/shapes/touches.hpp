// touches.hpp -- rays at one part of a shape, and what is known of the surface where they meet it: by differences between
// neighbouring rays, without a word of the shape's own surface function.
#pragma once
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "device/device.hpp"
#include "rt_types.h"
#include "scene/vec.hpp"
#include "tools/check/hits/checked_scene.hpp"
#include "tools/check/shapes/shape_values.hpp"
#include "worker/guarded_memory.hpp"

namespace clarity::check {

// Calls the two functions of a shape's kernels alone, on a device, with guards around what they read.

// One part of a shape, in the shape's own space.
struct ShapeSubject {
    std::string what;  // the statement it comes from, and its number
    std::array<float, 3> lo{}, hi{};
    float size = 0;        // diagonal of the box
    float coordinate = 0;  // largest coordinate of the box
    float error = 0;       // what the host tells `<id>_surface`
    std::shared_ptr<const GuardedBytes> numbers, more;
};
// The parts of a shape that the plugin accepted: all, or `most` of them, from first to last.
std::vector<ShapeSubject> subjects_of(const rt_plugin& plugin, const ShapeTrial& trial, size_t most);

struct ProbeHit {
    float t = 0, u = 0, v = 0;
};
struct ProbePoint {
    float at[3], u, v;
};
struct ProbeSurface {
    float normal[3], height, error, tex_u, tex_v;
};

// The kernels of one shape, compiled for one number of lanes.
class ShapeProbe {
 public:
    // Throws Error(kernel_build_failed).
    ShapeProbe(const rt_plugin& plugin, std::shared_ptr<Device> device, const Variant& variant);
    std::vector<ProbeHit> hits(const ShapeSubject& subject, const std::vector<rt_ray>& rays);
    std::vector<ProbeSurface> surfaces(const ShapeSubject& subject, const std::vector<ProbePoint>& points);

 private:
    void run(cl::Kernel& kernel, const ShapeSubject& subject, const void* in, size_t in_bytes, void* out, size_t out_bytes,
             size_t count, const float* error);

    std::shared_ptr<Device> device_;
    const size_t lanes_;
    cl::Kernel hits_, surfaces_;
};

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
