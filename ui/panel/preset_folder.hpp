// preset_folder.hpp -- presets by name: each is a file in one folder.
#pragma once
#include <string>
#include <vector>

namespace clarity::ui {

// The names of the presets in `folder`, sorted. Empty if the folder is missing.
std::vector<std::string> preset_names(const std::string& folder);
// Returns FOLDER/NAME.json and creates the folder if it is missing. A name that is a path and ends in .json is returned
// unchanged. Throws Error(usage) if the name cannot be a file name or `folder` is empty, Error(failed) if the folder cannot be
// created.
std::string preset_path(const std::string& folder, const std::string& name);

}  // namespace clarity::ui
