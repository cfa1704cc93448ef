// surface_probe.hpp -- calls the three functions of a model of surfaces alone, on a device, with guards around its numbers.
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "device/device.hpp"
#include "rt_surface.h"
#include "worker/guarded_memory.hpp"

namespace clarity::check {

// A material with the model.
struct SurfaceSubject {
    std::string what;  // "`model oren_nayar  color 1 1 1  grooves 0.5`"
    std::array<float, 3> color{};
    std::shared_ptr<const GuardedBytes> numbers;
};
// values: of each key.
SurfaceSubject surface_subject(const rt_plugin& plugin, const std::array<float, 3>& color,
                               const std::vector<std::array<double, 3>>& values);
std::vector<std::array<double, 3>> surface_defaults(const rt_plugin& plugin);
// Materials of the color: with all keys at their defaults, each at its least and its greatest value, and all of them there.
std::vector<SurfaceSubject> surface_subjects(const rt_plugin& plugin, const std::array<float, 3>& color);

struct SurfaceQuery {
    float wo[3], wi[3], u[3];
};
struct SurfaceAnswer {
    float wi[3], weight[3], pdf;      // drawn for wo and u
    float f[3], density;              // of the query's wi
    float drawn_f[3], drawn_density;  // of the direction that was drawn; 0 where none was
    bool drawn() const { return pdf > 0 && wi[2] > 0; }
};

// The kernels of one model: the contract of rt_surface.h and the plugin's file, and nothing else of the host.
class SurfaceProbe {
 public:
    // Throws Error(kernel_build_failed).
    SurfaceProbe(const rt_plugin& plugin, std::shared_ptr<Device> device);
    std::vector<SurfaceAnswer> ask(const SurfaceSubject& subject, const std::vector<SurfaceQuery>& queries);

 private:
    std::shared_ptr<Device> device_;
    cl::Kernel kernel_;
};

}  // namespace clarity::check
