// emitter_table.hpp -- what emits light in a frame, with its power, as kernels of a path tracer pick it
// (cl/shading/emitters.h).
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "render/accel/accel_build.hpp"
#include "render/view/view.hpp"
#include "scene/scene.hpp"

namespace clarity {

// Primitives that emit light, and what a path tracer can do about them.
struct EmissiveCounts {
    uint64_t triangles = 0, spheres = 0, polygons = 0;  // that light is drawn from
    // Found by rays alone that happen to hit them: planes, shapes of plugins, polygons that are not convex, and what exceeds
    // the table.
    uint64_t planes = 0, shapes = 0, bent_polygons = 0, too_many = 0;
};

struct EmitterTable {
    std::vector<rt_emitter> emitters;  // 2^cell_bits of them
    std::vector<rt_emitter_run> runs;
    rt_lighting lighting{};
    EmissiveCounts counts;
};

// Headers below cl/ of kernels with kPicksLights, in their order. Before them come sampling/math.h and sampling/warps.h.
const std::vector<const char*>& emitter_headers();

// The emitters of a view. accel: where the scene's primitives are now; only positions in leaf order must be those of the
// device.
EmitterTable make_emitter_table(const Scene& scene, const AccelData& accel, const View& view);

// Whether a planar polygon, 3 numbers a corner, is convex and its corners are in a plane.
bool is_convex(const float* corners, size_t count);

}  // namespace clarity
