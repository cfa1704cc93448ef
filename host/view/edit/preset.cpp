#include "view/edit/preset.hpp"

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/read_file.hpp"
#include "base/numbers.hpp"
#include "base/text.hpp"
#include "plugin/parameters.hpp"
#include "view/settings/accel_choice.hpp"

namespace clarity {
namespace {

using Json = nlohmann::ordered_json;

const rt_plugin* accel_of(const PluginRegistry& plugins, const std::string& id, const std::string& name) {
    if (const rt_plugin* plugin = plugins.accel(id)) return plugin;
    throw Error(Exit::usage,
                name + ": it needs the acceleration structure `" + id + "`, but no plugin has this id: see `clarity plugins`");
}

// Returns a parameter's key and value: "max_leaf=4".
Word parameter_word(const rt_plugin& plugin, const ParameterValues& values, size_t index) {
    const std::string text = parameter_text(plugin, values, index);
    const size_t equals = text.find('=');
    return {text.substr(0, equals), text.substr(equals + 1)};
}

// Reads the members of a JSON object. Values that are not strings are taken as JSON text.
std::vector<Word> words_of(const Json& object, const std::string& name, const std::string& what) {
    if (!object.is_object()) throw Error(Exit::usage, name + ": `" + what + "` is no object");
    std::vector<Word> words;
    for (const auto& [key, value] : object.items()) {
        const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
        words.push_back({key, text});
    }
    return words;
}

}  // namespace

std::string preset_json(const PluginRegistry& plugins, const Preset& preset) {
    Json json;
    json["clarity_preset"] = 1;
    json["device"] = preset.device;
    const std::string id = preset.settings.accel.empty() ? default_accel(plugins, preset.device) : preset.settings.accel;
    const rt_plugin& accel = *accel_of(plugins, id, "preset");
    json["accel"] = {{"id", accel.id}};
    for (size_t i = 0; i < preset.settings.accel_params.size(); ++i) {
        const Word word = parameter_word(accel, preset.settings.accel_params, i);
        json["accel"][word.key] = word.value;
    }
    json["settings"] = Json::object();
    for (const Setting& row : settings_table()) json["settings"][row.key] = row.get(preset.settings);
    // An array, because a light that is set and then switched off has two edits with the same key.
    json["edits"] = Json::array();
    for (const Word& word : preset.edits) json["edits"].push_back({word.key, word.value});
    if (preset.pose.time_s) json["pose"] = {{"clip", preset.pose.clip}, {"time_s", *preset.pose.time_s}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Preset parse_preset(const PluginRegistry& plugins, const std::string& text, const std::string& name) {
    Preset preset;
    try {
        const Json json = Json::parse(text);
        if (!json.is_object() || !json.contains("clarity_preset"))
            throw Error(Exit::usage, name + ": is no preset of Clarity: it has no `clarity_preset`");
        if (json["clarity_preset"] != 1)
            throw Error(Exit::usage,
                        name + ": is a preset of version " + json["clarity_preset"].dump() + "; this program reads 1");
        for (const auto& [key, value] : json.items())
            if (key != "clarity_preset" && key != "device" && key != "accel" && key != "settings" && key != "edits" &&
                key != "pose")
                throw Error(Exit::usage,
                            name + ": `" + key + "` is not part of a preset (device, accel, settings, edits, pose)");
        preset.device = json.value("device", std::string());
        if (json.contains("settings"))
            for (const Word& word : words_of(json["settings"], name, "settings"))
                set_setting(preset.settings, word.key, word.value);
        std::vector<Word> accel;
        if (json.contains("accel")) accel = words_of(json["accel"], name, "accel");
        for (const Word& word : accel)
            if (word.key == "id") preset.settings.accel = word.value;
        if (preset.settings.accel.empty()) preset.settings.accel = default_accel(plugins, preset.device);
        const rt_plugin& plugin = *accel_of(plugins, preset.settings.accel, name);
        preset.settings.accel_params = default_parameters(plugin);
        for (const Word& word : accel)
            if (word.key != "id") set_parameter(plugin, preset.settings.accel_params, word.key, word.value);
        if (json.contains("edits"))
            for (const Json& pair : json["edits"]) {
                if (!pair.is_array() || pair.size() != 2 || !pair[0].is_string() || !pair[1].is_string() ||
                    !is_edit(pair[0].get<std::string>()))
                    throw Error(Exit::usage, name + ": " + pair.dump() + " is no edit [\"light.0\", \"off\"]");
                preset.edits.push_back({pair[0], pair[1]});
            }
        if (json.contains("pose")) {
            preset.pose.clip = json["pose"].value("clip", std::string());
            preset.pose.time_s = json["pose"].at("time_s").get<double>();
        }
    } catch (const nlohmann::json::exception& error) {
        throw Error(Exit::usage, name + ": is no preset: " + error.what());
    } catch (const Error& error) {
        const std::string what = error.what();
        throw what.compare(0, name.size(), name) == 0 ? error : Error(error.code(), name + ": " + what);
    }
    return preset;
}

void save_preset(const PluginRegistry& plugins, const Preset& preset, const std::string& path) {
    write_text_file(path, preset_json(plugins, preset));
}

Preset load_preset(const PluginRegistry& plugins, const std::string& path) {
    return parse_preset(plugins, read_file(path, kMaxTextFileBytes, Exit::usage), path);
}

std::string render_command(const PluginRegistry& plugins, const Preset& preset, const std::vector<std::string>& files,
                           const std::string& output) {
    static const Settings defaults;
    std::string line = "clarity render";
    for (const std::string& file : files) line += " " + shell_word(file);
    line += " -o " + shell_word(output);
    if (!preset.device.empty()) line += " --device " + shell_word(preset.device);
    const std::string usual_accel = default_accel(plugins, preset.device);
    const std::string id = preset.settings.accel.empty() ? usual_accel : preset.settings.accel;
    const rt_plugin& accel = *accel_of(plugins, id, "the command line");
    std::string structure = accel.id;
    const ParameterValues usual = default_parameters(accel);
    for (size_t i = 0; i < preset.settings.accel_params.size() && i < usual.size(); ++i)
        if (preset.settings.accel_params[i] != usual[i])
            structure += "," + parameter_text(accel, preset.settings.accel_params, i);
    if (structure != usual_accel) line += " --accel " + shell_word(structure);
    for (const Setting& row : settings_table())
        if (const std::string value = row.get(preset.settings); value != row.get(defaults))
            line += " --set " + shell_word(row.key + "=" + value);
    if (preset.pose.time_s) {
        line += " --time=" + exact_text(*preset.pose.time_s);
        if (!preset.pose.clip.empty()) line += " --clip=" + shell_word(preset.pose.clip);
    }
    for (const Word& word : preset.edits) line += " --set " + shell_word(word.key + "=" + word.value);
    return line;
}

}  // namespace clarity
