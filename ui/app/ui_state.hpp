// ui_state.hpp -- what the window remembers by itself, besides the session.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "ui/app/key_map.hpp"

namespace clarity::ui {

enum class Tab { render, scene, inspect, statistics, log, plugins, help };
inline constexpr const char* kTabNames[] = {"Render", "Scene", "Inspect", "Stats", "Log", "Plugins", "Help"};
inline constexpr int kTabCount = 7;

// How two sides are shown.
enum class CompareMode { wipe, side_by_side, difference };
inline constexpr const char* kCompareNames[] = {"Wipe", "Side by side", "Difference"};

struct Bookmark {
    std::string name;
    Camera camera;
};

// What the file browser was opened for.
enum class BrowseFor { scene, preset, folder_of_pictures };

struct UiState {
    const KeyMap* key_map = &key_maps().front();
    float text_scale = 1;  // on top of the screen's own
    float camera_speed = 1, light_speed = 1;
    bool panel_visible = true;
    Tab tab = Tab::render;
    bool tab_asked = false;         // bring `tab` to the front
    bool focus_path_asked = false;  // put the keyboard into the field for a file's path
    std::string path;               // in that field
    CompareMode compare_mode = CompareMode::wipe;
    float wipe = 0.5f;           // of the picture's width: `main` is left of it
    bool inspect_hover = false;  // the inspector follows the mouse
    bool show_lights = false;    // as handles in the picture, to be dragged
    bool show_rays = true;       // of the inspected pixel, drawn in the scene
    bool browser_open = false;   // the file browser
    BrowseFor browse_for = BrowseFor::scene;
    bool keys_open = false;                    // the list of keys over the picture
    std::string pictures_folder = ".";         // where pictures are saved
    int selected_ray = -1;                     // of the inspected pixel's, marked in the scene
    std::string browser_folder;                // where it is
    std::vector<std::string> recent_files;     // newest first
    std::vector<Bookmark> bookmarks;           // of the scene that is open
    float panel_width = 400;                   // at scale 1
    std::string presets_folder;                // empty: there is none
    std::string notice;                        // a short word on what was just done, for some seconds
    uint64_t notices = 0;                      // how many there were
    rt_u32 last_level = 2;                     // of the volumes that were shown last
    bool log_jump = false;                     // the log scrolls to its last error
    int room_width = 1024, room_height = 768;  // pixels of the screen that a picture could fill
    void notify(const std::string& text) {
        notice = text;
        ++notices;
    }
    void browse(BrowseFor what) {
        browse_for = what;
        browser_open = true;
    }
    void show_tab(Tab which) {
        tab = which;
        tab_asked = panel_visible = true;
    }
};

}  // namespace clarity::ui
