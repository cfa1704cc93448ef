// multi_preparer.hpp -- what several devices need for one picture: a structure, built once, and a program and buffers on each.
#pragma once
#include <memory>
#include <vector>

#include "render/frame/renderer.hpp"

namespace clarity {

using Devices = std::vector<std::shared_ptr<Device>>;

// One that cannot be opened is a warning, as long as another can. Throws Error(no_device) of the first if none can. open: those
// among them are taken as they are, since one context a device is enough.
Devices open_devices(const std::vector<DeviceInfo>& infos, const Devices& open = {});
std::vector<DeviceInfo> infos_of(const Devices& devices);

// "NVIDIA H200", or "2 x NVIDIA H200", "NVIDIA H200 + AMD EPYC"; parts of a CPU are not told apart.
std::string devices_name(const std::vector<DeviceInfo>& infos);

// Of the devices that can take part, at least one; of the others a warning was given.
struct MultiPrepared {
    struct Part {
        std::shared_ptr<Device> device;
        std::shared_ptr<const Prepared> prepared;
    };
    std::vector<Part> parts;
    const std::shared_ptr<const Prepared>& first() const { return parts.front().prepared; }
    const std::shared_ptr<const Prepared>* of(const std::shared_ptr<Device>& device) const;  // null: it takes no part
};

// As Preparer, for one device or several.
class MultiPreparer {
 public:
    MultiPreparer(const PluginRegistry& plugins, const Devices& devices);
    // What is no fault of one device - a builder, a program that does not compile - is thrown, and so is a failure of all.
    std::shared_ptr<const MultiPrepared> prepare(std::shared_ptr<const Scene> scene, const Settings& settings,
                                                 Progress& progress);
    bool needs_reopen() const;
    // As Preparer::close_device().
    std::vector<DeviceInfo> close_devices();
    // Gives each preparer the device of its id. A device that is missing here stays closed.
    void open_devices(const Devices& devices);

 private:
    const PluginRegistry& plugins_;
    std::vector<std::unique_ptr<Preparer>> preparers_;
    const std::vector<DeviceInfo> infos_;  // one for each preparer
    Devices devices_;                      // the same; nullptr: closed
};

}  // namespace clarity
