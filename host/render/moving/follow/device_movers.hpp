// device_movers.hpp -- several devices that trace one picture move their copies of its structure together.
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "device/device.hpp"
#include "render/moving/pose_mover.hpp"

namespace clarity {

// On devices, each of which has the structure in its memory: see DeviceMover. Returns after they are done. rest: the scene at
// rest. nullptr: they cannot, for the reason in *why.
std::unique_ptr<PoseMover> make_device_mover(
    std::shared_ptr<const Scene> scene, std::shared_ptr<const AccelData> built, const std::shared_ptr<const Scene>& rest,
    const std::vector<std::pair<std::shared_ptr<Device>, std::shared_ptr<const DeviceScene>>>& on_devices, std::string* why);

}  // namespace clarity
