// trace_options.cpp -- turns the options of the command line into checked values.
#include <sys/stat.h>

#include <cerrno>
#include <cstring>

#include "base/error.hpp"
#include "cli/commands.hpp"
#include "import/file_access.hpp"
#include "import/importer_choice.hpp"
#include "view/edit/preset.hpp"
#include "view/settings/accel_choice.hpp"

namespace clarity {

TraceWords read_trace_options(const PluginRegistry& plugins, const TraceOptions& options) {
    TraceWords words;
    if (!options.preset.empty()) {
        const Preset preset = load_preset(plugins, options.preset);
        words = {preset.device, preset.settings, preset.edits, preset.pose};
    }
    if (!options.device.empty()) words.device = options.device;
    for (const std::string& pair : options.sets) {
        const size_t equals = pair.find('=');
        if (equals == std::string::npos || equals == 0)
            throw Error(Exit::usage, "--set " + pair + ": expected key=value, as in --set shadows=false");
        const std::string key = pair.substr(0, equals), value = pair.substr(equals + 1);
        if (is_edit(key))
            words.edits.push_back({key, value});
        else
            set_setting(words.settings, key, value);
    }
    for (const auto& [key, value] : options.settings) set_setting(words.settings, key, value);
    if (!options.accel.empty() || options.preset.empty())
        choose_accel(plugins, options.accel.empty() ? default_accel(plugins, words.device) : options.accel, words.settings);
    return words;
}

import::ImportOptions import_options(const SceneOptions& scene, const TraceWords& words) {
    import::ImportOptions options = scene.import;
    options.pictures = pictures_of(words.edits);
    return options;
}  // namespace clarity

void check_scene(const PluginRegistry& plugins, const SceneOptions& options) {
    import::parse_importer_choices(plugins, options.import.importers);
    check_scene_files(options.files);
}

void check_scene_files(const std::vector<std::string>& files) {
    for (const std::string& file : files) {
        struct stat status{};
        if (stat(file.c_str(), &status) != 0) {
            const std::string hint = file.find_first_of("./") == std::string::npos
                                         ? "; nor is it a command: `clarity --help` lists them"
                                         : "; check the name and the folder";
            throw Error(Exit::import_failed, file + ": " + std::strerror(errno) + hint);
        }
        import::check_readable(file);
    }
}

}  // namespace clarity
