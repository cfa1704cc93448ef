// shape_probe.hpp -- calls the two functions of a shape's kernels alone, on a device, with guards around what they read.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "check/hits/checked_scene.hpp"
#include "check/shapes/shape_values.hpp"
#include "device/device.hpp"
#include "render/accel/guarded_memory.hpp"
#include "rt_types.h"

namespace clarity::check {

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

}  // namespace clarity::check
