// preferences.hpp -- what the window remembers from run to run, as JSON under XDG_CONFIG_HOME/clarity.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "ui/app/ui_state.hpp"

namespace clarity::ui {

struct Preferences {
    int width = 1280, height = 800;
    float text_scale = 1, camera_speed = 1, light_speed = 1;
    std::string key_map = "thesis";
    bool panel_visible = true;
    float panel_width = 400;  // at scale 1
    CompareMode compare_mode = CompareMode::wipe;
    float moving_fps = 30;
    bool show_rays = true;
    std::string browser_folder, pictures_folder = ".";
    std::vector<std::string> recent_files;                   // newest first
    std::map<std::string, std::vector<Bookmark>> bookmarks;  // by the scene's files, one a line
    std::vector<std::string> bookmarked;                     // keys of it, newest first
};
inline constexpr size_t kRecentFiles = 20, kBookmarkedScenes = 100;

// The folder, made if it is missing; empty if there is none to write to, or if CLARITY_UI_NO_SAVE is set (then nothing is
// read either: a test starts from the defaults).
std::string preferences_folder();
// A missing file gives the defaults; values out of range are brought into it. Of a damaged file, every entry that can be read
// counts. The file itself is kept under another name, since the next save would replace it. notice: gets the message that says
// so, which otherwise is a warning in the log.
Preferences load_preferences(const std::string& folder, std::string* notice = nullptr);
// Written to a temporary file, then renamed. A failure is a warning in the log.
void save_preferences(const std::string& folder, const Preferences& preferences);

}  // namespace clarity::ui
