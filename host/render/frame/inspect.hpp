// inspect.hpp -- the tree of rays behind one pixel of a picture.
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "render/frame/renderer.hpp"

namespace clarity {

struct RayRecord {
    enum class Kind { camera, mirror, refracted, shadow };
    enum class Fate {
        traced,
        dropped,    // its packet's ray slots were full
        too_light,  // below min_weight
        too_deep,   // beyond the last generation
        unasked     // a light's share while shadows are off: no ray was traced
    };
    Kind kind = Kind::camera;
    Fate fate = Fate::traced;
    int parent = -1;                             // index in RayTree::rays; -1: the camera's
    unsigned generation = 1;                     // 1: the camera's; a shadow ray has that of the ray that it belongs to
    std::array<float, 3> origin{}, direction{};  // world; the direction has unit length
    float t = 0;                    // to what it hit, +inf: nothing. Not traced: 0. Shadow: to the light, +inf: a sun
    std::array<float, 3> weight{};  // share of what it sees that reaches the pixel
    std::array<float, 3> light{};   // linear RGB that it adds to the pixel; a surface's own and ambient light stand at
                                    // the ray that hit it, a light's at its shadow ray
    int prim = -1, instance = -1, material = -1;  // of what it hit; not of shadow rays
    int light_index = -1;                         // of shadow rays
    bool occluded = false;
    unsigned steps = 0, leaf_tests = 0;  // nodes visited and primitives tested by the rays that were traced side by side
};

struct RayTree {
    std::vector<RayRecord> rays;   // parents before children; the first is the camera ray
    bool truncated = false;        // there were more than the room for them
    std::array<float, 3> color{};  // linear RGB of the pixel: the sum of all rays' light
    unsigned overflowed = 0;       // traversal stacks of its packet that were full (debug programs); the log tells, too
};

// Usable from one thread at a time, beside a Frames of the same device on another.
class Inspector {
 public:
    explicit Inspector(std::shared_ptr<Device> device);
    ~Inspector();
    // Sample 0 of pixel (x, y), y from the top, exactly as Frames::trace() computes it, its whole packet included, so that what
    // is dropped there is dropped here. The first call for a program compiles another one. Throws Error(usage) for a pixel
    // outside the picture, Error(kernel_build_failed), Error(failed).
    RayTree trace(const Prepared& prepared, const Settings& settings, const View& view, unsigned x, unsigned y);

 private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace clarity
