// preset_folder.hpp -- presets by name: files in one folder.
#pragma once
#include <string>
#include <vector>

namespace clarity::ui {

// Names of the presets there, sorted; empty where the folder is missing.
std::vector<std::string> preset_names(const std::string& folder);
// FOLDER/NAME.json, the folder made if it is missing; a name that ends in .json is a path already. Throws Error(usage) where
// the name cannot be a file's, or there is no folder.
std::string preset_path(const std::string& folder, const std::string& name);

}  // namespace clarity::ui
