// levels.hpp -- the bounding volumes of a structure, for drawing.
#pragma once
#include <array>
#include <vector>

#include "rt_plugin.h"

namespace clarity {

class DeviceScene;
struct AccelData;

// Bounding volumes of one tree level, in world space, for drawing.
struct Volumes {
    std::vector<std::array<std::array<float, 3>, 8>> boxes;  // 8 corners; bits 0, 1, 2 of the index: high x, y, z
    std::vector<std::array<float, 4>> spheres;               // centre and radius
};
// Returns at most `limit` volumes. Level 0 is the root, RT_LEVEL_BOTTOM the leaves. Empty if the plugin has no levels().
// moved: the buffers of the structure if a device has moved it since its build. They are copied then; throws cl::Error.
Volumes accel_volumes(const AccelData& accel, rt_u32 level, size_t limit, const DeviceScene* moved = nullptr);

}  // namespace clarity
