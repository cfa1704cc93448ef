#include "import/importer_choice.hpp"

#include "base/error.hpp"

namespace clarity::import {
namespace {

std::string ids_of(const PluginRegistry& plugins) {
    std::string ids;
    for (const rt_plugin* plugin : plugins.importers()) ids += (ids.empty() ? "" : ", ") + std::string(plugin->id);
    return ids.empty() ? "none was found; `clarity plugins` says where and why" : "there are " + ids;
}

}  // namespace

ImporterParameters parse_importer_choices(const PluginRegistry& plugins, const std::vector<std::string>& texts) {
    ImporterParameters parameters;
    for (const std::string& text : texts) {
        const PluginChoice choice = parse_plugin_choice(text);
        const rt_plugin* plugin = plugins.importer(choice.id);
        if (!plugin) throw Error(Exit::usage, "--importer " + text + ": no importer `" + choice.id + "`; " + ids_of(plugins));
        if (choice.settings.empty())
            throw Error(Exit::usage, "--importer " + text +
                                         ": names no parameter, and a file chooses its importer by itself; expected "
                                         "ID,key=value (`clarity plugins` lists the keys)");
        ParameterValues& values = parameters.insert({choice.id, default_parameters(*plugin)}).first->second;
        for (const auto& [key, value] : choice.settings) set_parameter(*plugin, values, key, value);
    }
    return parameters;
}

}  // namespace clarity::import
