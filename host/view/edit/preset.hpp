// preset.hpp -- everything that determines a picture of a scene: settings, structure, device, view. As JSON, or as a command
// line.
//
//   {"clarity_preset": 1, "device": "0:0", "accel": {"id": "bvh2", "max_leaf": "4"}, "settings": {"depth": "4", ...},
//    "edits": [["camera", "..."], ["light.0", "off"], ...], "pose": {"clip": "walk", "time_s": 1.25}}
#pragma once
#include <string>
#include <vector>

#include "plugin/registry.hpp"
#include "scene/motion/pose_time.hpp"
#include "view/edit/edit.hpp"
#include "view/settings/settings.hpp"

namespace clarity {

// The contents of a preset.
struct Preset {
    std::string device;       // "": the default device
    Settings settings;        // with accel_params filled in
    std::vector<Word> edits;  // of the scene that is open; see edit.hpp
    PoseTime pose{};          // without a time: at rest
};

// Returns the preset as JSON text.
std::string preset_json(const PluginRegistry& plugins, const Preset& preset);
// Reads JSON text. Missing keys keep their defaults; an unknown key is an error. Throws Error(usage), which names `name`, the
// key and what is allowed.
Preset parse_preset(const PluginRegistry& plugins, const std::string& json, const std::string& name);
// Writes and reads a preset file. save_preset() throws Error(failed), load_preset() Error(usage), as parse_preset() does.
void save_preset(const PluginRegistry& plugins, const Preset& preset, const std::string& path);
Preset load_preset(const PluginRegistry& plugins, const std::string& path);

// Returns the command that renders this picture again: `clarity render FILES... -o OUT ...`, quoted for a shell. Settings at
// their defaults are left out.
std::string render_command(const PluginRegistry& plugins, const Preset& preset, const std::vector<std::string>& files,
                           const std::string& output);

}  // namespace clarity
