// multi_preparer.hpp -- prepares a scene for several devices: builds the structure once, compiles and uploads for each device.
#pragma once
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "base/progress.hpp"
#include "device/device.hpp"
#include "plugin/registry.hpp"
#include "scene/motion/pose.hpp"

namespace clarity {

class DeviceScene;
class PoseMover;
class Preparer;
struct AccelData;
struct MovedStructure;
struct Prepared;
struct Settings;

using Devices = std::vector<std::shared_ptr<Device>>;

// Opens devices. A device that cannot be opened causes a warning, as long as another can. If none can, throws the first
// device's Error(no_device). open: devices that are already open; these are reused, so that each has only one context.
Devices open_devices(const std::vector<DeviceInfo>& infos, const Devices& open = {});
std::vector<DeviceInfo> infos_of(const Devices& devices);
bool all_lost(const Devices& devices);  // false if there are none

// "NVIDIA H200", "2 x NVIDIA H200" or "NVIDIA H200 + AMD EPYC". All parts of a CPU count as that CPU.
std::string devices_name(const std::vector<DeviceInfo>& infos);

// The results for the devices that can take part; at least one. The others have caused a warning.
struct MultiPrepared {
    struct Part {
        std::shared_ptr<Device> device;
        std::shared_ptr<const Prepared> prepared;
    };
    std::vector<Part> parts;
    const std::shared_ptr<const Prepared>& first() const { return parts.front().prepared; }
    unsigned planes() const;            // of the films of its pictures
    std::string kernel_digest() const;  // of the kernels' text and options on the first device
    // Null if the device takes no part.
    const std::shared_ptr<const Prepared>* of(const std::shared_ptr<Device>& device) const;
    // Buffers for a refit of its structure, in a pose of its scene: all that the pose does not move is shared. Empty if the
    // pose moves vertices that the structure holds in the world's space.
    std::vector<std::pair<std::shared_ptr<Device>, std::shared_ptr<const DeviceScene>>> moved_buffers(
        const Pose& pose, const std::shared_ptr<const AccelData>& refitted, Progress& progress) const;
};

// The program of the first device, compiled once more with a text behind its own and further options: its kernel's entry, and
// what the compiler said.
struct CompiledOnce {
    cl::Program program;
    std::string text, log, entry;
};
CompiledOnce compile_once_more(const MultiPrepared& prepared, const std::string& text, const std::string& options);

// Has the functions of Preparer, for one device or several. Used from one thread.
class MultiPreparer {
 public:
    MultiPreparer(const PluginRegistry& plugins, const Devices& devices);
    ~MultiPreparer();
    // As Preparer::prepare(). A device that fails causes a warning, as long as another succeeds. Throws if all devices fail,
    // and for errors that do not concern a single device, such as a failed build or a program that does not compile.
    std::shared_ptr<const MultiPrepared> prepare(std::shared_ptr<const Scene> scene, const Settings& settings,
                                                 Progress& progress, std::shared_ptr<const AccelData> built = nullptr);
    // moved: the structure, and its buffers where they are on devices already.
    std::shared_ptr<const MultiPrepared> prepare(std::shared_ptr<const Scene> scene, const Settings& settings,
                                                 Progress& progress, const MovedStructure& moved);
    // As Preparer::build(), for the device with the most memory.
    std::shared_ptr<const AccelData> build(const std::shared_ptr<const Scene>& scene, const Settings& settings,
                                           Progress& progress);
    // What moves the structure that was prepared to other poses: the devices that trace it, or the host if one of them is a CPU
    // or cannot. scene: what was prepared. rest: the same scene at rest.
    std::unique_ptr<PoseMover> mover(const std::shared_ptr<const Scene>& scene, const std::shared_ptr<const Scene>& rest,
                                     const MultiPrepared& prepared) const;
    // The same, always the host. built: the structure of the scene.
    static std::unique_ptr<PoseMover> host_mover(const std::shared_ptr<const Scene>& scene,
                                                 const std::shared_ptr<const AccelData>& built);
    // As Preparer::builder(), for the device with the most memory.
    std::function<std::shared_ptr<const AccelData>(const Scene&, Progress&)> builder(const Settings& settings) const;
    // As Preparer::asks_for().
    bool asks_for(const AccelData& accel, const Settings& settings) const;
    bool needs_reopen() const;
    // As Preparer::close_device().
    std::vector<DeviceInfo> close_devices();
    // Gives each preparer the device of its id. A device that is missing here stays closed.
    void open_devices(const Devices& devices);

 private:
    Preparer& roomiest() const;

    const PluginRegistry& plugins_;
    std::vector<std::unique_ptr<Preparer>> preparers_;
    const std::vector<DeviceInfo> infos_;  // one for each preparer
    Devices devices_;                      // in the same order; nullptr: closed
};

// Prepares a scene for ray queries alone: the kernels of pictures are not compiled. Uploads a structure and returns what
// RayQueries::trace() needs; `program` is null. Lanes that the settings leave open are
// those that the device prefers. Throws Error(failed) and Cancelled.
std::shared_ptr<const Prepared> prepare_queries(Device& device, std::shared_ptr<const Scene> scene,
                                                std::shared_ptr<const AccelData> accel, const Settings& settings,
                                                Progress& progress);

}  // namespace clarity
