#include "view/settings/accel_choice.hpp"

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

std::vector<const rt_plugin*> accels_by_merit(const PluginRegistry& plugins, DeviceKind kind) {
    const auto merit = [kind](const rt_plugin* plugin) {
        return kind == DeviceKind::cpu ? plugin->accel->merit_cpu : plugin->accel->merit_gpu;
    };
    std::vector<const rt_plugin*> accels = plugins.accels();  // by id
    std::stable_sort(accels.begin(), accels.end(), [&](const rt_plugin* a, const rt_plugin* b) { return merit(a) > merit(b); });
    return accels;
}

const rt_plugin& best_accel(const PluginRegistry& plugins, DeviceKind kind) {
    const std::vector<const rt_plugin*> accels = accels_by_merit(plugins, kind);
    if (accels.empty()) throw Error(Exit::usage, "no acceleration structure: " + accel_names(plugins));
    return *accels.front();
}

DeviceKind kind_of(const std::vector<DeviceInfo>& devices) {
    const auto is_cpu = [](const DeviceInfo& info) { return info.cpu; };
    return std::all_of(devices.begin(), devices.end(), is_cpu) ? DeviceKind::cpu : DeviceKind::gpu;
}

std::string default_accel(const PluginRegistry& plugins, const std::string& device) {
    DeviceKind kind = DeviceKind::cpu;
    try {
        kind = kind_of(choose_devices(device));
    } catch (const Error&) {
        // Opening the device will report the error.
    }
    return best_accel(plugins, kind).id;
}

const rt_plugin& resolve_accel(const PluginRegistry& plugins, DeviceKind kind, Settings& settings) {
    if (settings.accel.empty()) {
        const rt_plugin& best = best_accel(plugins, kind);
        settings.accel = best.id;
        settings.accel_params = default_parameters(best);
        return best;
    }
    if (const rt_plugin* plugin = plugins.accel(settings.accel)) return *plugin;
    throw Error(Exit::usage, "no acceleration structure `" + settings.accel + "`; " + accel_names(plugins));
}

}  // namespace clarity
