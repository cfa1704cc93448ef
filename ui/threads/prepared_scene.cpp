#include "ui/threads/prepared_scene.hpp"

#include <algorithm>

#include "launch/prepared.hpp"
#include "scene/motion/deform.hpp"
#include "view/view.hpp"

namespace clarity::ui {

std::shared_ptr<const OnDevices> DeviceLoan::get() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return lent_;
}

bool DeviceLoan::withdrawn() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return !lent_;
}

bool DeviceLoan::lost() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return lent_ && all_lost(lent_->devices);
}

void DeviceLoan::withdraw() {
    std::shared_ptr<const OnDevices> last;  // destroyed after the lock is released, because drivers take their time
    const std::lock_guard<std::mutex> lock(mutex_);
    last.swap(lent_);
}

ReadySide::ReadySide(Devices chosen, std::shared_ptr<const MultiPrepared> prepared) : devices(infos_of(chosen)) {
    for (const MultiPrepared::Part& part : prepared->parts)
        parts.push_back({part.device->info(), part.prepared->settings.lanes});
    const Prepared& first = *prepared->first();
    accel = first.accel;
    settings = first.settings;
    upload_ms = first.upload_ms;
    compile_ms = first.compile_ms;
    compile_cached = first.compile_cached;
    program = first.program;
    device_bytes = first.device_bytes();
    loan = std::make_shared<DeviceLoan>(OnDevices{std::move(chosen), std::move(prepared)});
}

bool ReadySide::uses(const DeviceInfo& info) const {
    return std::any_of(devices.begin(), devices.end(), [&](const DeviceInfo& device) {
        return device.platform_index == info.platform_index && device.device_index == info.device_index;
    });
}

bool Ready::knows(const View& view) const {
    return clarity::knows(main.settings, *scene, view) && (!other || clarity::knows(other->settings, *scene, view));
}

const Deformation* left_out(const Ready& ready, rt_u32 mesh) {
    const auto found = std::find_if(ready.left_out.begin(), ready.left_out.end(),
                                    [mesh](const Deformation& deformation) { return deformation.mesh == mesh; });
    return found == ready.left_out.end() ? nullptr : &*found;
}

std::shared_ptr<const Scene> whole_scene(const Ready& ready) {
    if (ready.left_out.empty()) return ready.scene;
    auto scene = std::make_shared<Scene>(*ready.scene);
    for (const Deformation& deformation : ready.left_out) {
        const PosedMesh mesh = deformed(*ready.rest, deformation);
        std::copy(mesh.positions.begin(), mesh.positions.end(),
                  scene->positions.own().begin() + 3 * static_cast<std::ptrdiff_t>(scene->meshes[mesh.mesh].first_vertex));
    }
    return scene;
}

bool traces_alike(const Ready& a, const Ready& b) {
    const auto same = [](const ReadySide& x, const ReadySide& y) {
        const auto program = x.program.lock();
        return program && program == y.program.lock();
    };
    return a.loaded == b.loaded && same(a.main, b.main) && a.other.has_value() == b.other.has_value() &&
           (!a.other || same(*a.other, *b.other));
}

}  // namespace clarity::ui
