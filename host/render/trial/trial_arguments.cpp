#include "render/trial/trial_arguments.hpp"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "base/error.hpp"

namespace clarity {
namespace {

constexpr bool SceneFeatures::*kFeatures[] = {&SceneFeatures::instances, &SceneFeatures::spheres, &SceneFeatures::polygons,
                                              &SceneFeatures::planes,    &SceneFeatures::normals, &SceneFeatures::uvs,
                                              &SceneFeatures::textures};

}  // namespace

std::vector<std::string> words_of(const TrialArguments& arguments) {
    std::vector<std::string> words;
    const auto add = [&](const char* key, const std::string& value) { words.insert(words.end(), {key, value}); };
    add("--parent", std::to_string(getpid()));
    add("--kernels", arguments.kernels);
    add("--device", arguments.device);
    add("--device-name", arguments.device_name);
    add("--accel", arguments.settings.accel);
    for (const auto& [loaded, original] : arguments.libraries) {
        add("--library", loaded);
        add("--original", original);
    }
    std::string features;
    for (const auto feature : kFeatures) features += arguments.features.*feature ? '1' : '0';
    add("--features", features);
    for (const TrialShape& shape : arguments.shapes) {
        add("--shape", shape.id);
        for (const TrialShape::Part& part : shape.parts) add("--part", text_of(part));
    }
    for (const double value : arguments.settings.accel_params) {
        char text[40];
        std::snprintf(text, sizeof text, "%.17g", value);
        add("--parameter", text);
    }
    for (const Setting& setting : settings_table()) add("--set", setting.key + "=" + setting.get(arguments.settings));
    return words;
}

TrialArguments read_trial_arguments(int argc, char** argv) {
    TrialArguments arguments;
    std::string library;
    for (int i = 2; i + 1 < argc; i += 2) {
        const std::string key = argv[i], value = argv[i + 1];
        if (key == "--parent") {
            arguments.parent = std::strtol(value.c_str(), nullptr, 10);
        } else if (key == "--kernels") {
            arguments.kernels = value;
        } else if (key == "--device") {
            arguments.device = value;
        } else if (key == "--device-name") {
            arguments.device_name = value;
        } else if (key == "--accel") {
            arguments.settings.accel = value;
        } else if (key == "--library") {
            library = value;
        } else if (key == "--original" && !library.empty()) {
            arguments.libraries[library] = value;
        } else if (key == "--features") {
            size_t at = 0;
            for (const auto feature : kFeatures) {
                arguments.features.*feature = at < value.size() && value[at] == '1';
                ++at;
            }
        } else if (key == "--shape") {
            arguments.shapes.push_back({value, {}});
        } else if (key == "--part" && !arguments.shapes.empty()) {
            arguments.shapes.back().parts.push_back(read_part(value));
        } else if (key == "--parameter") {
            arguments.settings.accel_params.push_back(std::strtod(value.c_str(), nullptr));
        } else if (const size_t equals = value.find('='); key == "--set" && equals != std::string::npos) {
            set_setting(arguments.settings, value.substr(0, equals), value.substr(equals + 1));
        } else {
            throw Error(Exit::usage, key + " " + value + ": not understood");
        }
    }
    if (arguments.device.empty()) throw Error(Exit::usage, "no device is named");
    return arguments;
}

}  // namespace clarity
