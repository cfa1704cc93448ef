// query_scene.hpp -- prepares a scene for ray queries alone: the kernels of pictures are not compiled.
#pragma once
#include <memory>

#include "base/progress.hpp"
#include "device/device.hpp"
#include "launch/prepared.hpp"

namespace clarity {

// Uploads a structure and returns what RayQueries::trace() needs; `program` is null. Lanes that the settings leave open are
// those that the device prefers. Throws Error(failed) and Cancelled.
std::shared_ptr<const Prepared> prepare_queries(Device& device, std::shared_ptr<const Scene> scene,
                                                std::shared_ptr<const AccelData> accel, const Settings& settings,
                                                Progress& progress);

}  // namespace clarity
