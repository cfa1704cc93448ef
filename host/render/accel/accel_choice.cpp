#include "render/accel/accel_choice.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "device/device.hpp"
#include "plugin/parameters.hpp"

namespace clarity {
namespace {

std::string accel_names(const PluginRegistry& plugins) {
    std::string names;
    for (const rt_plugin* plugin : plugins.accels()) names += (names.empty() ? "" : ", ") + std::string(plugin->id);
    return names.empty() ? "none was found; `clarity plugins` says where and why" : "there are " + names;
}

}  // namespace

void choose_accel(const PluginRegistry& plugins, const std::string& text, Settings& settings) {
    const PluginChoice choice = parse_plugin_choice(text);
    const rt_plugin* plugin = plugins.accel(choice.id);
    if (!plugin)
        throw Error(Exit::usage,
                    "--accel " + text + ": no acceleration structure `" + choice.id + "`; " + accel_names(plugins));
    settings.accel = choice.id;
    settings.accel_params = default_parameters(*plugin);
    for (const auto& [key, value] : choice.settings) set_parameter(*plugin, settings.accel_params, key, value);
}

std::string default_accel(const PluginRegistry& plugins, const std::string& device) {
    const std::string otherwise = Settings().accel, on_gpu = "bvh4";
    if (!plugins.accel(on_gpu)) return otherwise;
    try {
        const std::vector<DeviceInfo> devices = choose_devices(device);
        const auto is_cpu = [](const DeviceInfo& info) { return info.cpu; };
        return std::all_of(devices.begin(), devices.end(), is_cpu) ? otherwise : on_gpu;
    } catch (const Error&) {
        return otherwise;  // whoever opens the device says what is wrong with it
    }
}

}  // namespace clarity
