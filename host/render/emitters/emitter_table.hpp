// emitter_table.hpp -- what emits light in a frame, with its power, as kernels of a path tracer pick it
// (cl/shading/emitters.h).
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "render/accel/accel_build.hpp"
#include "render/emitters/sky_table.hpp"
#include "render/view/view.hpp"
#include "scene/scene.hpp"

namespace clarity {

struct EmitterTable {
    std::vector<rt_emitter> emitters;  // 2^cell_bits of them
    std::vector<rt_emitter_run> runs;
    rt_lighting lighting{};
    uint64_t left_out = 0;  // emissive primitives beyond those that the table can hold: rays alone find them
};

// Headers below cl/ of kernels with kPicksLights, in their order. Before them come sampling/math.h and sampling/warps.h.
const std::vector<const char*>& emitter_headers();

// The emitters of a view. accel: where the scene's primitives are now; only positions in leaf order must be those of the
// device.
// sky: of scene.sky. knows_leaves: whether the device has the leaves in the order of accel. Where a device built a tree anew,
// the host does not know it, and emissive primitives are left to rays that hit them.
EmitterTable make_emitter_table(const Scene& scene, const AccelData& accel, const View& view, const SkyTable& sky,
                                bool knows_leaves = true);

}  // namespace clarity
