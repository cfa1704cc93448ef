// ui_state.hpp -- what the window remembers by itself, besides the session.
#pragma once
#include <string>

#include "ui/key_map.hpp"

namespace clarity {

enum class Tab { render, scene, statistics, log, plugins, help };
inline constexpr const char* kTabNames[] = {"Render", "Scene", "Stats", "Log", "Plugins", "Help"};

struct UiState {
    const KeyMap* key_map = &key_maps().front();
    float text_scale = 1;  // on top of the screen's own
    float camera_speed = 1, light_speed = 1;
    bool panel_visible = true;
    Tab tab = Tab::render;
    bool tab_asked = false;                    // bring `tab` to the front
    bool focus_path_asked = false;             // put the keyboard into the field for a file's path
    std::string path;                          // in that field
    int room_width = 1024, room_height = 768;  // pixels of the screen that a picture could fill
    void show_tab(Tab which) {
        tab = which;
        tab_asked = panel_visible = true;
    }
};

}  // namespace clarity
