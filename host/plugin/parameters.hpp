// parameters.hpp -- a plugin's parameters as values: parsing "bvh2,max_leaf=4", ranges, defaults.
#pragma once
#include <string>
#include <vector>

#include "rt_plugin.h"

namespace clarity {

// Values in the order declared.
using ParameterValues = std::vector<double>;

ParameterValues default_parameters(const rt_plugin& plugin);
// Sets one by key; BOOL takes 0/1/true/false/on/off, ENUM a choice's name or index. Throws Error(usage) that lists the keys,
// the range or the choices.
void set_parameter(const rt_plugin& plugin, ParameterValues& values, const std::string& key, const std::string& value);
// "max_leaf=4" / "split=sah": as set_parameter reads it.
std::string parameter_text(const rt_plugin& plugin, const ParameterValues& values, size_t index);

// "bvh2,max_leaf=4" -> id and key=value pairs. Throws Error(usage) on a malformed one.
struct PluginChoice {
    std::string id;
    std::vector<std::pair<std::string, std::string>> settings;
};
PluginChoice parse_plugin_choice(const std::string& text);

}  // namespace clarity
