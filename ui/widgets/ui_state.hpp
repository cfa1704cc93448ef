// ui_state.hpp -- the state of the window itself, apart from the session.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "scene/motion/pose_time.hpp"
#include "scene/scene.hpp"
#include "ui/widgets/key_map.hpp"

namespace clarity::ui {

enum class Tab { render, scene, inspect, statistics, log, plugins, help };
inline constexpr const char* kTabNames[] = {"Render", "Scene", "Inspect", "Stats", "Log", "Plugins", "Help"};
inline constexpr int kTabCount = 7;

// How the two sides of a comparison are shown.
enum class CompareMode { wipe, side_by_side, difference };
inline constexpr const char* kCompareNames[] = {"Wipe", "Side by side", "Difference"};

// A named view of a scene, with its time if the scene moves.
struct Bookmark {
    std::string name;
    Camera camera;
    PoseTime pose{};
};

// What the file browser is open for.
enum class BrowseFor { scene, preset, picture, folder_of_pictures };

struct UiState {
    const KeyMap* key_map = &key_maps().front();
    float text_scale = 1;  // factor on top of the screen's own scale
    float camera_speed = 1, light_speed = 1;
    bool panel_visible = true;
    Tab tab = Tab::render;
    bool tab_asked = false;         // `tab` is to be brought to the front
    bool focus_path_asked = false;  // the field for a file's path is to get the keyboard
    std::string path;               // text of that field
    CompareMode compare_mode = CompareMode::wipe;
    float wipe = 0.5f;           // position of the divider as a share of the picture's width; `main` is to the left of it
    bool inspect_hover = false;  // the inspector follows the mouse
    bool show_lights = false;    // lights have handles in the picture, which can be dragged
    bool move_handles = false;   // so has the selected instance
    bool show_rays = true;       // the rays of the inspected pixel are drawn in the scene
    bool browser_open = false;   // whether the file browser is shown
    BrowseFor browse_for = BrowseFor::scene;
    std::pair<rt_u32, rt_u32> empty_texture_row{RT_NONE, RT_NONE};  // its material and use: a use without a texture
    std::pair<rt_u32, rt_u32> picture_for{};                        // the material and the use (RT_MAP_) that get the picture
    bool keys_open = false;                                         // whether the list of keys is shown over the picture
    std::string pictures_folder = ".";                              // folder into which pictures are saved
    unsigned preview_texture = 0;  // of OpenGL, with the ball of the selected material; 0: there is none yet
    int selected_ray = -1;         // index of the ray that is marked in the scene, among those of the inspected pixel; -1: none
    bool show_paths = true;        // the brightest paths of the explained pixel are drawn in the scene
    int selected_path = -1;        // which of them is marked; -1: none
    int points_across = 0, points_up = 1;      // the dimensions of the random numbers that are shown
    std::string browser_folder;                // the folder that the file browser shows
    std::vector<std::string> recent_files;     // newest first
    std::vector<Bookmark> bookmarks;           // of the open scene
    size_t next_bookmark = 0;                  // which view the next press of N shows, among cameras and bookmarks
    float panel_width = 400;                   // in pixels at text scale 1
    std::string presets_folder;                // empty: there is none
    std::string notice;                        // short text about the last action, shown for a few seconds
    uint64_t notices = 0;                      // number of notices so far
    rt_u32 last_level = 2;                     // level of the bounding volumes that were shown last
    bool log_jump = false;                     // the log is to scroll to its last error
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
