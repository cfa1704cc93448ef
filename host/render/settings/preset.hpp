// preset.hpp -- all that makes a picture of a scene, as JSON: settings, structure, device, view. Also as words of a command
// line.
//
//   {"clarity_preset": 1, "device": "0:0", "accel": {"id": "bvh2", "max_leaf": "4"}, "settings": {"depth": "4", ...},
//    "edits": [["camera", "..."], ["light.0", "off"], ...]}
#pragma once
#include <string>
#include <vector>

#include "plugin/registry.hpp"
#include "render/settings/edit.hpp"
#include "render/settings/settings.hpp"

namespace clarity {

struct Preset {
    std::string device;       // "": any
    Settings settings;        // accel_params filled in
    std::vector<Word> edits;  // for the scene that is open; see edit.hpp
};

std::string preset_json(const PluginRegistry& plugins, const Preset& preset);
// Throws Error(usage) naming `name`, the key and what is allowed; an unknown key is an error, a missing one the default.
Preset parse_preset(const PluginRegistry& plugins, const std::string& json, const std::string& name);
void save_preset(const PluginRegistry& plugins, const Preset& preset, const std::string& path);
Preset load_preset(const PluginRegistry& plugins, const std::string& path);

// `clarity render FILES... -o OUT ...`: what makes this picture again, quoted for a shell. What stands at its default is left
// out.
std::string render_command(const PluginRegistry& plugins, const Preset& preset, const std::vector<std::string>& files,
                           const std::string& output);

}  // namespace clarity
