#include "render/moving/follow/device_movers.hpp"

#include <algorithm>

#include "device/cl_errors.hpp"
#include "render/moving/on_device/device_mover.hpp"

namespace clarity {
namespace {

class DeviceMovers : public PoseMover {
 public:
    explicit DeviceMovers(std::vector<std::pair<std::shared_ptr<Device>, std::unique_ptr<DeviceMover>>> movers)
        : movers_(std::move(movers)) {}
    const Problem& cannot() const override { return movers_.front().second->cannot(); }
    bool on_devices() const override { return true; }
    bool can_build() const override { return movers_.front().second->can_build(); }
    bool can_deform() const override {
        return std::all_of(movers_.begin(), movers_.end(), [](const auto& mover) { return mover.second->can_deform(); });
    }
    MovedStructure move(const Pose& pose, bool build, Progress& progress) override {
        if (progress.cancelled()) throw Cancelled();
        std::vector<MovedOnDevice> parts;
        for (const auto& [device, mover] : movers_) {
            parts.push_back(mover->move(pose, build ? DeviceMover::Update::build : DeviceMover::Update::refit));
            if (!parts.back().on_device) return parts.back();
        }
        MovedStructure moved;
        moved.accel = movers_.front().second->accel();
        moved.by_devices = true;
        for (size_t i = 0; i < parts.size(); ++i) {
            const Device& device = *movers_[i].first;
            wrap_cl_errors(device, "moving the scene", [&] {
                parts[i].end.wait();
                return 0;
            });
            moved.on_devices.emplace_back(movers_[i].first, parts[i].on_device);
            moved.worst_cost_ratio = std::max(moved.worst_cost_ratio, parts[i].worst_cost_ratio);
            moved.refitted = parts[i].refitted;
            if (i == 0) moved.groups = std::move(parts[i].groups);
            moved.ms = std::max(moved.ms, span_ms(parts[i].begin, parts[i].end, parts[i].ms));
        }
        return moved;
    }

 private:
    std::vector<std::pair<std::shared_ptr<Device>, std::unique_ptr<DeviceMover>>> movers_;
};

}  // namespace

std::unique_ptr<PoseMover> make_device_mover(
    std::shared_ptr<const Scene> scene, std::shared_ptr<const AccelData> built, const std::shared_ptr<const Scene>& rest,
    const std::vector<std::pair<std::shared_ptr<Device>, std::shared_ptr<const DeviceScene>>>& on_devices, std::string* why) {
    std::vector<std::pair<std::shared_ptr<Device>, std::unique_ptr<DeviceMover>>> movers;
    for (const auto& [device, on_device] : on_devices) {
        movers.emplace_back(device, std::make_unique<DeviceMover>(device, scene, built, on_device, rest));
        *why = movers.back().second->cannot().text();
        if (!why->empty()) return nullptr;
    }
    if (movers.empty()) return nullptr;
    return std::make_unique<DeviceMovers>(std::move(movers));
}

}  // namespace clarity
