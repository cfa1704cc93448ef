// emitter_table.hpp -- what emits light in a frame, with its power, as kernels of a path tracer pick it
// (cl/shading/emitters.h).
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "launch/emitters/light_tree.hpp"
#include "launch/emitters/sky_table.hpp"
#include "scene/scene.hpp"
#include "structures/accel_build.hpp"
#include "view/view.hpp"

namespace clarity {

struct EmitterTable {
    std::vector<rt_emitter> emitters;  // 2^cell_bits of them
    std::vector<rt_emitter_run> runs;
    std::vector<rt_light_node> nodes;  // of the light tree
    rt_lighting lighting{};
    uint64_t left_out = 0;  // emissive primitives beyond those that the table can hold: rays alone find them
};

// Headers below cl/ of kernels with kPicksLights, in their order. Before them come sampling/math.h and sampling/warps.h.
const std::vector<const char*>& emitter_headers();

// What a device has moved, as it is there.
struct MovedPrims {
    std::vector<rt_packed_prim> leaves;
    std::vector<rt_instance> instances;
};

// The emitters of a view. accel: where the scene's primitives are now. sky: of scene.sky. moved: leaves and instances in place
// of those of accel; nullptr: nothing has moved on the device. tree: emitters with light that falls off with the distance are
// in a light tree, which has one place in the table.
EmitterTable make_emitter_table(const Scene& scene, const AccelData& accel, const View& view, const SkyTable& sky,
                                const MovedPrims* moved, bool tree);
// Whether a surface emits, so that the table depends on where primitives are.
bool has_emitting_surfaces(const Scene& scene, const View& view);

}  // namespace clarity
