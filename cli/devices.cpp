// clarity devices: lists the OpenCL devices (like `clinfo -l`) in the order of preference, and tells which of them are used
// without --device.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "device/device.hpp"

namespace clarity {
namespace {

using Json = nlohmann::ordered_json;

const char* type_name(const DeviceInfo& device) {
    return device.gpu ? "gpu" : device.cpu ? "cpu" : "other";
}

constexpr const char* kSeveral =
    "\nSeveral devices can share a picture: --device 0,1 or gpus or all. cpu/2 is a CPU split in two, cpu/2.0 a half.\n";

// The devices which a command without --device uses, and the reason.
struct Default {
    std::vector<DeviceInfo> devices;
    std::string why;
    std::string ids() const { return device_list_text(devices); }
    bool has(const DeviceInfo& device) const {
        return std::any_of(devices.begin(), devices.end(), [&](const DeviceInfo& one) {
            return one.platform_index == device.platform_index && one.device_index == device.device_index;
        });
    }
};

Default find_default(const std::vector<DeviceInfo>& devices) {
    const char* variable = std::getenv("CLARITY_DEVICE");
    if (variable && *variable) {
        const std::string from = std::string("CLARITY_DEVICE=") + variable;
        try {
            return {choose_devices({}), from};
        } catch (const Error& e) {
            return {{}, e.what()};
        }
    }
    if (devices.empty()) return {{}, "there is no device"};
    const DeviceInfo& best = devices.front();
    if (devices.size() == 1) return {{best}, "the only one"};
    const bool same_kind = devices[1].gpu == best.gpu && devices[1].cpu == best.cpu;
    if (same_kind) return {{best}, std::string("most compute units x clock of every ") + type_name(best)};
    return {{best}, best.gpu ? "a GPU is preferred to a CPU" : "a CPU is preferred to other devices"};
}

Json device_json(const DeviceInfo& device, size_t number, const Default& chosen) {
    return {{"number", number},
            {"id", device.id()},
            {"platform_index", device.platform_index},
            {"device_index", device.device_index},
            {"platform", device.platform},
            {"name", device.name},
            {"vendor", device.vendor},
            {"version", device.version},
            {"driver", device.driver},
            {"type", type_name(device)},
            {"compute_units", device.compute_units},
            {"clock_mhz", device.clock_mhz},
            {"global_bytes", device.global_bytes},
            {"max_allocation_bytes", device.max_allocation_bytes},
            {"lanes", device.preferred_lanes()},
            {"default", chosen.has(device)}};
}

void print_device(const DeviceInfo& device, size_t number, const Default& chosen) {
    print_text("%zu = %-5s %s  [%s, %u compute units", number, device.id().c_str(), device.name.c_str(), type_name(device),
               device.compute_units);
    if (device.clock_mhz > 0) print_text(" at %u MHz", device.clock_mhz);
    print_text(", %s, lanes %u]\n", memory_text(device.global_bytes).c_str(), device.preferred_lanes());
    print_text("          %s, driver %s\n", device.platform.c_str(), device.driver.c_str());
    if (chosen.has(device)) print_text("          default: %s\n", chosen.why.c_str());
}

}  // namespace

int run_devices(bool json) {
    std::vector<DeviceWarning> warnings;
    const std::vector<DeviceInfo> devices = list_devices(&warnings);
    const Default chosen = find_default(devices);
    if (json) {
        Json list = {
            {"devices", Json::array()}, {"default", chosen.devices.empty() ? Json() : Json(chosen.ids())}, {"why", chosen.why}};
        for (size_t i = 0; i < devices.size(); ++i) list["devices"].push_back(device_json(devices[i], i, chosen));
        list["warnings"] = Json::array();
        for (const DeviceWarning& warning : warnings) list["warnings"].push_back(warning.text);
        std::printf("%s\n", list.dump(2, ' ', false, Json::error_handler_t::replace).c_str());
    } else {
        for (size_t i = 0; i < devices.size(); ++i) print_device(devices[i], i, chosen);
        for (const DeviceWarning& warning : warnings)
            if (!devices.empty()) print_text("          %s\n", warning.text.c_str());  // else the error below has them
        if (chosen.devices.empty() && !devices.empty()) print_text("          no default: %s\n", chosen.why.c_str());
        if (!devices.empty()) print_text("%s", kSeveral);
    }
    if (devices.empty()) choose_device({});  // throws, and says what to install
    return static_cast<int>(Exit::done);
}

}  // namespace clarity
