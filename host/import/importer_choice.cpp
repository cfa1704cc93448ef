#include "import/importer_choice.hpp"

#include "base/error.hpp"

namespace clarity::import {
namespace {

std::string ids_of(const PluginRegistry& plugins) {
    std::string ids;
    for (const rt_plugin* plugin : plugins.importers()) ids += (ids.empty() ? "" : ", ") + std::string(plugin->id);
    return ids.empty() ? "none was found; `clarity plugins` says where and why" : "there are " + ids;
}

bool read_flag(const std::string& text, const std::string& value) {
    if (value == "true" || value == "1") return true;
    if (value == "false" || value == "0") return false;
    throw Error(Exit::usage,
                "--importer " + text + ": undeformed=" + value +
                    ": expected true or false (true: neither skins nor morphs move meshes at rest; default false)");
}

}  // namespace

ImporterParameters parse_importer_choices(const PluginRegistry& plugins, const std::vector<std::string>& texts) {
    ImporterParameters parameters;
    for (const std::string& text : texts) {
        const PluginChoice choice = parse_plugin_choice(text);
        const rt_plugin* plugin = plugins.importer(choice.id);
        const bool is_any = choice.id == "any";
        if (!plugin && !is_any)
            throw Error(Exit::usage, "--importer " + text + ": no importer `" + choice.id + "`; " + ids_of(plugins));
        if (choice.settings.empty())
            throw Error(Exit::usage, "--importer " + text +
                                         ": names no parameter, and a file chooses its importer by itself; expected "
                                         "ID,key=value (`clarity plugins` lists the keys)");
        for (const auto& [key, value] : choice.settings) {
            if (key == "undeformed") {
                if (read_flag(text, value))
                    parameters.undeformed.insert(choice.id);
                else
                    parameters.undeformed.erase(choice.id);
            } else if (is_any) {
                throw Error(Exit::usage, "--importer " + text + ": any has no parameter '" + key + "'; it has: undeformed");
            } else {
                const ParameterValues defaults = default_parameters(*plugin);
                set_parameter(*plugin, parameters.values.insert({choice.id, defaults}).first->second, key, value);
            }
        }
    }
    return parameters;
}

}  // namespace clarity::import
