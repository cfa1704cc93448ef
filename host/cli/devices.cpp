// clarity devices: what clinfo -l shows, in the order of preference, and which one is taken without --device.
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>

#include "base/error.hpp"
#include "cli/commands.hpp"
#include "device/device.hpp"

namespace clarity {
namespace {

using Json = nlohmann::ordered_json;

const char* type_name(const DeviceInfo& device) {
    return device.gpu ? "gpu" : device.cpu ? "cpu" : "other";
}

// As Device::preferred_lanes, without opening the device.
unsigned lanes_of(const DeviceInfo& device) {
    return !device.cpu ? 1 : device.float_width >= 16 ? 16 : device.float_width >= 8 ? 8 : 4;
}

// Which device a command without --device takes, and why.
struct Default {
    std::string id, why;
};

Default find_default(const std::vector<DeviceInfo>& devices) {
    const char* variable = std::getenv("CLARITY_DEVICE");
    if (variable && *variable) {
        const std::string from = std::string("CLARITY_DEVICE=") + variable;
        try {
            return {choose_device({}).id(), from};
        } catch (const Error& e) {
            return {{}, e.what()};
        }
    }
    if (devices.empty()) return {{}, "there is no device"};
    const DeviceInfo& best = devices.front();
    if (devices.size() == 1) return {best.id(), "the only one"};
    const bool same_kind = devices[1].gpu == best.gpu && devices[1].cpu == best.cpu;
    if (same_kind) return {best.id(), std::string("most compute units x clock of every ") + type_name(best)};
    return {best.id(), best.gpu ? "a GPU goes before a CPU" : "a CPU goes before other devices"};
}

std::string memory_text(uint64_t bytes) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f GiB", double(bytes) / double(1u << 30));
    return text;
}

Json device_json(const DeviceInfo& device, const Default& chosen) {
    return {{"id", device.id()},
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
            {"lanes", lanes_of(device)},
            {"default", device.id() == chosen.id}};
}

void print_device(const DeviceInfo& device, const Default& chosen) {
    std::printf("%-5s %s  [%s, %u compute units", device.id().c_str(), device.name.c_str(), type_name(device),
                device.compute_units);
    if (device.clock_mhz > 0) std::printf(" at %u MHz", device.clock_mhz);
    std::printf(", %s, lanes %u]\n", memory_text(device.global_bytes).c_str(), lanes_of(device));
    std::printf("      %s, driver %s\n", device.platform.c_str(), device.driver.c_str());
    if (device.id() == chosen.id) std::printf("      default: %s\n", chosen.why.c_str());
}

}  // namespace

int run_devices(bool json) {
    std::vector<std::string> warnings;
    const std::vector<DeviceInfo> devices = list_devices(&warnings);
    const Default chosen = find_default(devices);
    if (json) {
        Json list = {
            {"devices", Json::array()}, {"default", chosen.id.empty() ? Json() : Json(chosen.id)}, {"why", chosen.why}};
        for (const DeviceInfo& device : devices) list["devices"].push_back(device_json(device, chosen));
        list["warnings"] = warnings;
        std::printf("%s\n", list.dump(2, ' ', false, Json::error_handler_t::replace).c_str());
    } else {
        for (const DeviceInfo& device : devices) print_device(device, chosen);
        for (const std::string& warning : warnings)
            if (!devices.empty()) std::printf("      %s\n", warning.c_str());  // else they are part of the error
        if (chosen.id.empty() && !devices.empty()) std::printf("      no default: %s\n", chosen.why.c_str());
    }
    if (devices.empty()) choose_device({});  // throws, with what to install
    return static_cast<int>(Exit::done);
}

}  // namespace clarity
