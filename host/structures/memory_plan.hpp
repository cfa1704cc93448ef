// memory_plan.hpp -- estimates a scene's memory on a device before anything is built or uploaded.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/text.hpp"
#include "device/device.hpp"
#include "rt_plugin.h"
#include "scene/scene.hpp"

namespace clarity {

// A buffer and its size.
struct MemoryPiece {
    std::string what;  // "leaves"
    uint64_t bytes = 0;
};

// Sizes of a builder's input.
struct SceneCounts {
    uint64_t references = 0;  // primitives in leaves, at least; those of a mesh count once, however often it is placed
    uint64_t triangles = 0;   // how many of these are triangles
};
SceneCounts count_scene(const Scene& scene);

// Returns the buffers' sizes as far as they are known before the build. The size of nodes is a lower bound: one node for twelve
// primitives, as in trees of eight children a node and four primitives a leaf. All sums and products have 64 bits.
std::vector<MemoryPiece> plan_memory(const SceneCounts& counts, const Scene& scene, const rt_accel& accel);

// Throws Error(failed), with sizes and advice, if the buffers do not fit into the device's memory or one is larger than the
// device allows for a single buffer. scene: a description such as "871414 triangles in bvh4".
void check_fits(const std::vector<MemoryPiece>& pieces, const DeviceInfo& device, const std::string& scene);

}  // namespace clarity
