// importer_choice.hpp -- values for the parameters of importers, as --importer gives them.
#pragma once
#include <map>
#include <set>
#include <string>
#include <vector>

#include "plugin/parameters.hpp"
#include "plugin/registry.hpp"

namespace clarity::import {

// Importers that are not named have their defaults.
struct ImporterParameters {
    std::map<std::string, ParameterValues> values;  // by the importer's id
    // Importers whose meshes stay as their file stores them: neither skins nor morphs move them at rest. "any" is all of them.
    std::set<std::string> undeformed;
    bool deforms(const std::string& id) const { return undeformed.count(id) == 0 && undeformed.count("any") == 0; }
};

// The words of the option --undeformed.
inline constexpr const char* kUndeformed = "any,undeformed=true";

// texts: "ID,key=value...". An id may be named several times. The host gives each importer the parameter `undeformed`. The id
// `any` stands for all of them, and has only this one. Throws Error(usage) for an unknown importer, key or value.
ImporterParameters parse_importer_choices(const PluginRegistry& plugins, const std::vector<std::string>& texts);

}  // namespace clarity::import
