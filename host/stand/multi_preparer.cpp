#include "stand/multi_preparer.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/digest.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "device/cl_errors.hpp"
#include "device/device.hpp"
#include "device/program.hpp"
#include "frames/preparer.hpp"
#include "kernels/program_cache.hpp"
#include "launch/device_scene.hpp"
#include "moving/moved_instances.hpp"
#include "moving/on_device/device_mover.hpp"
#include "moving/on_host/host_mover.hpp"
#include "moving/pose_mover.hpp"
#include "view/settings/accel_choice.hpp"

namespace clarity {
namespace {

// Several devices that trace one picture move their copies of its structure together.

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

// On devices, each of which has the structure in its memory: see DeviceMover. Returns after they are done. rest: the scene at
// rest. nullptr: they cannot, for the reason in *why.
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

// The buffers of a structure on a device; nullptr: it has none there yet.
GivenBuffers buffers_on(const std::shared_ptr<Device>& device, const MovedStructure& structure) {
    for (const auto& [other, buffers] : structure.on_devices)
        if (other == device) return {buffers, structure.by_devices};
    return {};
}

}  // namespace

Devices open_devices(const std::vector<DeviceInfo>& infos, const Devices& open) {
    Devices devices;
    std::vector<Error> failures;
    for (const DeviceInfo& info : infos) {
        const auto same = [&](const auto& device) { return device->info().id() == info.id(); };
        const auto found = std::find_if(open.begin(), open.end(), same);
        try {
            devices.push_back(found == open.end() ? std::make_shared<Device>(info) : *found);
        } catch (const Error& e) {
            failures.push_back(e);
        }
    }
    if (devices.empty()) throw failures.front();
    for (const Error& e : failures) log(LogLevel::warning, std::string(e.what()) + "; the others go on without it");
    return devices;
}

std::vector<DeviceInfo> infos_of(const Devices& devices) {
    std::vector<DeviceInfo> infos;
    for (const auto& device : devices) infos.push_back(device->info());
    return infos;
}

bool all_lost(const Devices& devices) {
    return !devices.empty() &&
           std::all_of(devices.begin(), devices.end(), [](const auto& device) { return device->loss()->lost(); });
}

std::string devices_name(const std::vector<DeviceInfo>& infos) {
    std::vector<std::pair<std::string, unsigned>> counted;
    for (const DeviceInfo& info : infos) {
        const std::string name = info.name_of_whole();
        const auto same = [&](const auto& other) { return other.first == name; };
        const auto found = std::find_if(counted.begin(), counted.end(), same);
        if (found == counted.end())
            counted.emplace_back(infos.size() == 1 ? info.name : name, 1);
        else
            ++found->second;
    }
    std::string text;
    for (const auto& [name, count] : counted)
        text += (text.empty() ? "" : " + ") + (count > 1 ? std::to_string(count) + " x " : std::string()) + name;
    return text;
}

unsigned MultiPrepared::planes() const {
    return film_planes(first()->program->row);
}

std::string MultiPrepared::kernel_digest() const {
    const KernelSource source = kernel_for(*first(), first()->program->row);
    Digest digest;
    digest.add(source.text);
    digest.add(source.options);
    for (const double parameter : first()->settings.accel_params) digest.add_value(parameter);
    return digest.hex().substr(0, 8);
}

CompiledOnce compile_once_more(const MultiPrepared& prepared, const std::string& text, const std::string& options) {
    Device& device = *prepared.parts.front().device;
    const KernelRow& row = prepared.first()->program->row;
    const KernelSource source = kernel_for(*prepared.first(), row);
    const std::string whole = source.text + text;
    const BuildResult built = build_program(device, whole, options_for(device.info(), source) + options, source.what);
    return {built.program, whole, built.log, row.entry};
}

const std::shared_ptr<const Prepared>* MultiPrepared::of(const std::shared_ptr<Device>& device) const {
    for (const Part& part : parts)
        if (part.device == device) return &part.prepared;
    return nullptr;
}

std::vector<std::pair<std::shared_ptr<Device>, std::shared_ptr<const DeviceScene>>> MultiPrepared::moved_buffers(
    const Pose& pose, const std::shared_ptr<const AccelData>& refitted, Progress& progress) const {
    std::vector<std::pair<std::shared_ptr<Device>, std::shared_ptr<const DeviceScene>>> buffers;
    if (moves_flattened_mesh(pose, *first()->scene, first()->accel->scene)) return buffers;
    for (const Part& part : parts)
        buffers.emplace_back(part.device, std::make_shared<DeviceScene>(*part.device, part.prepared->on_device, refitted,
                                                                        pose.meshes, progress));
    return buffers;
}

MultiPreparer::MultiPreparer(const PluginRegistry& plugins, const Devices& devices)
    : plugins_(plugins), infos_(infos_of(devices)), devices_(devices) {
    for (const auto& device : devices) preparers_.push_back(std::make_unique<Preparer>(plugins, device));
}

MultiPreparer::~MultiPreparer() = default;

std::shared_ptr<const MultiPrepared> MultiPreparer::prepare(std::shared_ptr<const Scene> scene, const Settings& settings,
                                                            Progress& progress, std::shared_ptr<const AccelData> built) {
    MovedStructure structure;
    structure.accel = std::move(built);
    return prepare(std::move(scene), settings, progress, structure);
}

std::shared_ptr<const AccelData> MultiPreparer::build(const std::shared_ptr<const Scene>& scene, const Settings& asked,
                                                      Progress& progress) {
    Settings settings = asked;
    resolve_accel(plugins_, kind_of(infos_), settings);
    return roomiest().build(scene, settings, progress);
}

std::shared_ptr<const MultiPrepared> MultiPreparer::prepare(std::shared_ptr<const Scene> scene, const Settings& asked,
                                                            Progress& progress, const MovedStructure& given) {
    auto prepared = std::make_shared<MultiPrepared>();
    Settings settings = asked;
    resolve_accel(plugins_, kind_of(infos_), settings);
    if (preparers_.size() == 1) {
        prepared->parts = {{devices_[0], preparers_[0]->prepare(std::move(scene), settings, progress, given.accel,
                                                                buffers_on(devices_[0], given))}};
        return prepared;
    }
    // The device with the most memory decides whether the scene is built at all. Devices that it is too large for fail below.
    std::shared_ptr<const AccelData> built = given.accel;
    if (!built) built = roomiest().build(scene, settings, progress);
    std::vector<Error> failures;
    for (size_t i = 0; i < preparers_.size(); ++i) {
        try {
            prepared->parts.push_back(
                {devices_[i], preparers_[i]->prepare(scene, settings, progress, built, buffers_on(devices_[i], given))});
        } catch (const Error& e) {
            if (e.code() != Exit::failed && e.code() != Exit::no_device) throw;
            failures.push_back(e);
        }
    }
    if (prepared->parts.empty()) throw failures.front();
    for (const Error& e : failures) log(LogLevel::warning, std::string(e.what()) + "; the other devices go on without it");
    return prepared;
}

std::unique_ptr<PoseMover> MultiPreparer::mover(const std::shared_ptr<const Scene>& scene,
                                                const std::shared_ptr<const Scene>& rest, const MultiPrepared& prepared) const {
    std::vector<std::pair<std::shared_ptr<Device>, std::shared_ptr<const DeviceScene>>> on_devices;
    for (const MultiPrepared::Part& part : prepared.parts)
        if (!part.device->info().cpu) on_devices.emplace_back(part.device, part.prepared->on_device);
    const std::shared_ptr<const AccelData>& built = prepared.first()->accel;
    if (on_devices.size() == prepared.parts.size()) {
        std::string why;
        if (auto mover = make_device_mover(scene, built, rest, on_devices, &why)) return mover;
        log(LogLevel::info, "the scene moves on the host: " + why);
    }
    return host_mover(scene, built);
}

std::unique_ptr<PoseMover> MultiPreparer::host_mover(const std::shared_ptr<const Scene>& scene,
                                                     const std::shared_ptr<const AccelData>& built) {
    return std::make_unique<HostMover>(scene, built);
}

Preparer& MultiPreparer::roomiest() const {
    const auto most = std::max_element(
        infos_.begin(), infos_.end(), [](const DeviceInfo& a, const DeviceInfo& b) { return a.global_bytes < b.global_bytes; });
    return *preparers_[size_t(most - infos_.begin())];
}

AccelBuilder MultiPreparer::builder(const Settings& asked) const {
    Settings settings = asked;
    resolve_accel(plugins_, kind_of(infos_), settings);
    return roomiest().builder(settings);
}

bool MultiPreparer::asks_for(const AccelData& accel, const Settings& asked) const {
    Settings settings = asked;
    resolve_accel(plugins_, kind_of(infos_), settings);
    return preparers_.front()->asks_for(accel, settings);
}

bool MultiPreparer::needs_reopen() const {
    return std::any_of(preparers_.begin(), preparers_.end(), [](const auto& preparer) { return preparer->needs_reopen(); });
}

std::vector<DeviceInfo> MultiPreparer::close_devices() {
    for (auto& device : devices_) device.reset();
    for (const auto& preparer : preparers_) preparer->close_device();
    return infos_;
}

void MultiPreparer::open_devices(const Devices& devices) {
    for (size_t i = 0; i < preparers_.size(); ++i)
        for (const auto& device : devices)
            if (device->info().id() == infos_[i].id()) {
                devices_[i] = device;
                preparers_[i]->open_device(device);
            }
}

std::shared_ptr<const Prepared> prepare_queries(Device& device, std::shared_ptr<const Scene> scene,
                                                std::shared_ptr<const AccelData> accel, const Settings& settings,
                                                Progress& progress) {
    auto prepared = std::make_shared<Prepared>();
    prepared->scene = scene;
    prepared->accel = accel;
    Settings& s = prepared->settings = settings;
    s.accel = accel->plugin->id;
    s.accel_params = accel->params;
    resolve_packet(s, device.info());
    prepared->layout = make_layout(s, device.info().traces_packets());
    progress.stage("uploading the scene");
    wrap_cl_errors(device, "uploading the scene", [&] {
        prepared->on_device = std::make_shared<DeviceScene>(device, std::move(scene), std::move(accel), progress);
        return 0;
    });
    return prepared;
}

}  // namespace clarity
