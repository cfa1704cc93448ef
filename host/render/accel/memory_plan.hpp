// memory_plan.hpp -- what a scene takes on a device, known before anything is built or uploaded.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/memory_text.hpp"
#include "device/device.hpp"
#include "render/accel/accel_build.hpp"

namespace clarity {

// One buffer.
struct MemoryPiece {
    std::string what;  // "leaves"
    uint64_t bytes = 0;
};

// What a builder is given, counted.
struct SceneCounts {
    uint64_t references = 0;  // primitives in leaves, at least: those of a mesh once, however often it is placed
    uint64_t triangles = 0;   // of these
};
SceneCounts count_scene(const Scene& scene);

// Buffers by size, as far as it is known before the build. Of nodes it is the least: one for each twelve primitives, which is
// what trees of eight children and leaves of four come to. Adding up and products are of 64 bits.
std::vector<MemoryPiece> plan_memory(const SceneCounts& counts, const Scene& scene, const rt_accel& accel);

// Throws Error(failed), with the numbers and what to do, where the pieces do not fit into the device, or one of them is larger
// than it allows in one piece. scene: "871414 triangles in bvh4".
void check_fits(const std::vector<MemoryPiece>& pieces, const DeviceInfo& device, const std::string& scene);

}  // namespace clarity
