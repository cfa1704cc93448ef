#include "ui/panel/preset_folder.hpp"

#include <algorithm>
#include <filesystem>

#include "base/error.hpp"

namespace clarity::ui {
namespace fs = std::filesystem;

std::vector<std::string> preset_names(const std::string& folder) {
    std::vector<std::string> names;
    if (folder.empty()) return names;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
        if (entry->path().extension() == ".json") names.push_back(entry->path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

std::string preset_path(const std::string& folder, const std::string& name) {
    if (fs::path(name).extension() == ".json" && fs::path(name).has_parent_path()) return name;
    if (name.empty() || name.front() == '.' || name.find('/') != std::string::npos)
        throw Error(Exit::usage, "`" + name +
                                     "` cannot be the name of a preset: a name has no slash and does not begin with a dot; "
                                     "for a file in another folder, give a path that ends in .json");
    if (folder.empty())
        throw Error(Exit::usage, "the preset " + name +
                                     " has no folder, because the window keeps no preferences: give a path "
                                     "that ends in .json");
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw Error(Exit::failed, folder + ": cannot create this folder for presets: " + error.message());
    return (fs::path(folder) / (fs::path(name).extension() == ".json" ? name : name + ".json")).string();
}

}  // namespace clarity::ui
