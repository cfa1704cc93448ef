// preferences.hpp -- the settings which the window keeps from run to run, as JSON under XDG_CONFIG_HOME/clarity.
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "ui/threads/desired_state.hpp"
#include "ui/widgets/ui_state.hpp"

namespace clarity::ui {

struct Preferences {
    int width = 1280, height = 800;
    float text_scale = 1, camera_speed = 1, light_speed = 1;
    std::string key_map = "thesis";
    bool panel_visible = true;
    float panel_width = 400;  // in pixels at text scale 1
    CompareMode compare_mode = CompareMode::wipe;
    float moving_fps = kMovingFps;
    bool show_rays = true;
    std::string browser_folder, pictures_folder = ".";
    std::vector<std::string> recent_files;                   // newest first
    std::map<std::string, std::vector<Bookmark>> bookmarks;  // key: the paths of the scene's files, one a line
    std::vector<std::string> bookmarked;                     // the keys of `bookmarks`, newest first
};
inline constexpr size_t kRecentFiles = 20, kBookmarkedScenes = 100;

// Returns the folder, and creates it if it is missing. Returns an empty text if no folder can be written, or if
// CLARITY_UI_NO_SAVE is set. Tests set it: nothing is read either then, so that the window starts from the defaults.
std::string preferences_folder();
// Reads the preferences. A missing file gives the defaults; values out of range are clamped. Of a damaged file, every entry
// that can be read is used. The damaged file itself is renamed, because the next save would overwrite it. notice: receives the
// message about a damaged file; without it, the message is a warning in the log.
Preferences load_preferences(const std::string& folder, std::string* notice = nullptr);
// Writes a temporary file, then renames it. A failure is a warning in the log.
void save_preferences(const std::string& folder, const Preferences& preferences);

// Conversion of preferences to JSON and back.
nlohmann::json to_json(const Preferences& preferences);
// Values out of range are clamped; missing ones get their defaults. Throws nlohmann::json::exception if an entry has the wrong
// type. With `problems`, each such failure is appended there and the entry is left out; then it throws only if `json` is not an
// object.
Preferences preferences_from(const nlohmann::json& json, std::vector<std::string>* problems = nullptr);

}  // namespace clarity::ui
