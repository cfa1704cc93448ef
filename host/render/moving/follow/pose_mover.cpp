#include "render/moving/follow/pose_mover.hpp"

#include <algorithm>

#include "device/cl_errors.hpp"
#include "render/moving/on_device/device_motion.hpp"
#include "render/moving/on_host/moving_accel.hpp"

namespace clarity {
namespace {

class HostMover : public PoseMover {
 public:
    HostMover(std::shared_ptr<const Scene> scene, std::shared_ptr<const AccelData> built)
        : moving_(std::move(scene), std::move(built)) {}
    const std::string& cannot() const override { return moving_.cannot(); }
    MovedStructure move(const Pose& pose, bool, Progress& progress) override {
        MovedAccel moved = moving_.move(pose, progress);
        return {std::move(moved.accel), {},      std::move(moved.why), moved.worst_cost_ratio, std::move(moved.groups),
                moved.refitted,         moved.ms};
    }

 private:
    MovingAccel moving_;
};

class DeviceMover : public PoseMover {
 public:
    explicit DeviceMover(std::vector<std::pair<std::shared_ptr<Device>, std::unique_ptr<DeviceMotion>>> motions)
        : motions_(std::move(motions)) {}
    const std::string& cannot() const override { return motions_.front().second->cannot(); }
    bool on_devices() const override { return true; }
    bool can_build() const override { return motions_.front().second->can_build(); }
    bool can_deform() const override {
        return std::all_of(motions_.begin(), motions_.end(), [](const auto& motion) { return motion.second->can_deform(); });
    }
    MovedStructure move(const Pose& pose, bool build, Progress& progress) override {
        if (progress.cancelled()) throw Cancelled();
        std::vector<MovedOnDevice> parts;
        for (const auto& [device, motion] : motions_) {
            parts.push_back(motion->move(pose, build ? DeviceMotion::Update::build : DeviceMotion::Update::refit));
            if (!parts.back().on_device) return {nullptr, {}, parts.back().why};
        }
        MovedStructure moved;
        moved.accel = motions_.front().second->accel();
        moved.by_devices = true;
        for (size_t i = 0; i < parts.size(); ++i) {
            const Device& device = *motions_[i].first;
            wrap_cl_errors(device, "moving the scene", [&] {
                parts[i].end.wait();
                return 0;
            });
            moved.on_devices.emplace_back(motions_[i].first, parts[i].on_device);
            moved.worst_cost_ratio = std::max(moved.worst_cost_ratio, parts[i].worst_cost_ratio);
            moved.refitted = parts[i].refitted;
            if (i == 0) moved.groups = std::move(parts[i].groups);
            moved.ms = std::max(moved.ms, span_ms(parts[i].begin, parts[i].end, parts[i].ms));
        }
        return moved;
    }

 private:
    std::vector<std::pair<std::shared_ptr<Device>, std::unique_ptr<DeviceMotion>>> motions_;
};

}  // namespace

std::unique_ptr<PoseMover> make_host_mover(std::shared_ptr<const Scene> scene, std::shared_ptr<const AccelData> built) {
    return std::make_unique<HostMover>(std::move(scene), std::move(built));
}

std::unique_ptr<PoseMover> make_device_mover(
    std::shared_ptr<const Scene> scene, std::shared_ptr<const AccelData> built, const std::shared_ptr<const Scene>& rest,
    const std::vector<std::pair<std::shared_ptr<Device>, std::shared_ptr<const DeviceScene>>>& on_devices, std::string* why) {
    std::vector<std::pair<std::shared_ptr<Device>, std::unique_ptr<DeviceMotion>>> motions;
    for (const auto& [device, on_device] : on_devices) {
        motions.emplace_back(device, std::make_unique<DeviceMotion>(device, scene, built, on_device, rest));
        *why = motions.back().second->cannot();
        if (!why->empty()) return nullptr;
    }
    if (motions.empty()) return nullptr;
    return std::make_unique<DeviceMover>(std::move(motions));
}

}  // namespace clarity
