// inspect.hpp -- the tree of rays that contribute to one pixel.
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "device/device.hpp"
#include "launch/prepared.hpp"
#include "view/settings/settings.hpp"
#include "view/view.hpp"

namespace clarity {

// One ray of that tree.
struct RayRecord {
    enum class Kind { camera, mirror, refracted, shadow };
    enum class Fate {
        traced,
        dropped,    // the ray slots of its packet were full
        too_light,  // its weight was below min_weight
        too_deep,   // it was beyond the last generation
        unasked     // a light's share while shadows are off: no shadow ray was traced
    };
    Kind kind = Kind::camera;
    Fate fate = Fate::traced;
    int parent = -1;          // index in RayTree::rays; -1: the camera ray
    unsigned generation = 1;  // the camera ray's is 1; a shadow ray has the generation of the ray that sent it
    std::array<float, 3> origin{}, direction{};  // world space; the direction has unit length
    // Distance to the hit, +inf if there is none, 0 if the ray was not traced. Shadow rays: distance to the light, +inf for a
    // sun.
    float t = 0;
    std::array<float, 3> weight{};  // share of the light found by this ray that reaches the pixel
    // Linear RGB that this record adds to the pixel. Emitted and ambient light belong to the ray that hit the surface; the
    // light of a light source belongs to its shadow ray.
    std::array<float, 3> light{};
    int prim = -1, instance = -1, material = -1;  // of the hit; -1 for shadow rays
    int light_index = -1;                         // the light that a shadow ray goes to; -1 for other rays
    bool occluded = false;
    unsigned steps = 0, leaf_tests = 0;  // nodes visited and primitives tested by all rays traced in the same packet
};

struct RayTree {
    std::vector<RayRecord> rays;   // parents come before their children; the first is the camera ray
    bool truncated = false;        // there were more rays than the buffer holds
    std::array<float, 3> color{};  // linear RGB of the pixel: the sum of all rays' light
    unsigned overflowed = 0;       // traversal stacks of its packet that were full (debug programs); also logged
};

// Traces single pixels and records their rays. Used from one thread at a time; a FrameRenderer may use the same device
// meanwhile.
class Inspector {
 public:
    explicit Inspector(std::shared_ptr<Device> device);
    ~Inspector();
    // Returns the rays of sample 0 of pixel (x, y); y counts from the top. The pixel's whole packet is traced exactly as
    // FrameRenderer::trace() does, so the same rays are dropped. The first call for a program compiles a variant of it. Throws
    // Error(usage) for a pixel outside the picture, Error(kernel_build_failed), Error(failed).
    RayTree trace(const Prepared& prepared, const Settings& settings, const View& view, unsigned x, unsigned y);

 private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace clarity
