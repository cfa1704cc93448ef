// parameters.hpp -- values of a plugin's parameters: defaults, ranges, and parsing of "bvh2,max_leaf=4".
#pragma once
#include <string>
#include <vector>

#include "rt_plugin.h"

namespace clarity {

// Values in the order in which the plugin declares its parameters.
using ParameterValues = std::vector<double>;

ParameterValues default_parameters(const rt_plugin& plugin);
// The values, with the default in the place of each that is missing or out of its range. They may come from another build of
// the plugin.
ParameterValues fitting_parameters(const rt_plugin& plugin, const ParameterValues& values);
// Sets the parameter `key`. BOOL takes 0/1/true/false/on/off, ENUM takes the name or index of a choice. Throws Error(usage),
// which lists the keys, the range or the choices.
void set_parameter(const rt_plugin& plugin, ParameterValues& values, const std::string& key, const std::string& value);
// A parameter as text, "max_leaf=4" or "split=sah", which set_parameter() can read.
std::string parameter_text(const rt_plugin& plugin, const ParameterValues& values, size_t index);

// A plugin's id with key=value pairs, as in "bvh2,max_leaf=4". Parsing throws Error(usage) if the text is malformed.
struct PluginChoice {
    std::string id;
    std::vector<std::pair<std::string, std::string>> settings;
};
PluginChoice parse_plugin_choice(const std::string& text);

}  // namespace clarity
