// importer_choice.hpp -- values for the parameters of importers, as --importer gives them.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "plugin/parameters.hpp"
#include "plugin/registry.hpp"

namespace clarity::import {

// By the importer's id. Importers that are not named have their defaults.
using ImporterParameters = std::map<std::string, ParameterValues>;

// texts: "ID,key=value...". An id may be named several times. Throws Error(usage) for an unknown importer, key or value.
ImporterParameters parse_importer_choices(const PluginRegistry& plugins, const std::vector<std::string>& texts);

}  // namespace clarity::import
