#include "ui/widgets/key_map.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace clarity::ui {
namespace {

// Adds the bindings which all presets share.
void add_common(KeyMap& map) {
    const char* levels = "show that level of the bounding volumes; again: hide";
    static const char* const digits[] = {"1", "2", "3", "4", "5", "6", "7", "8", "9"};
    for (int i = 0; i < 9; ++i) map.bindings.push_back({GLFW_KEY_1 + i, digits[i], Action::show_level, i, levels});
    map.bindings.push_back({GLFW_KEY_0, "0", Action::show_bottom_level, 0, "show the bottom level"});
    map.bindings.push_back({GLFW_KEY_F, "F", Action::print_frame_rate, 0, "print the frame rate to the console"});
    map.bindings.push_back({GLFW_KEY_C, "C", Action::toggle_compare, 0, "compare two settings, or no longer"});
    map.bindings.push_back({GLFW_KEY_X, "X", Action::swap_sides, 0, "swap the two sides"});
    map.bindings.push_back({GLFW_KEY_R, "R", Action::toggle_inspector, 0, "follow the rays of the pixel under the mouse"});
    map.bindings.push_back({GLFW_KEY_L, "L", Action::toggle_lights, 0, "show the lights, to drag them"});
    map.bindings.push_back({GLFW_KEY_G, "G", Action::frame_scene, 0, "bring what is selected into view, or all"});
    map.bindings.push_back({GLFW_KEY_B, "B", Action::add_bookmark, 0, "bookmark this view"});
    map.bindings.push_back({GLFW_KEY_N, "N", Action::next_bookmark, 0, "next bookmark, or camera of the file"});
    map.bindings.push_back({GLFW_KEY_Z, "Ctrl+Z", Action::undo, 0, "undo, redo a setting", true});
    map.bindings.push_back({GLFW_KEY_Y, "Ctrl+Y", Action::redo, 0, "undo, redo a setting", true});
    map.bindings.push_back({GLFW_KEY_O, "Ctrl+O", Action::open_file, 0, "open a file", true});
    map.bindings.push_back({GLFW_KEY_S, "Ctrl+S", Action::save_picture, 0, "save the picture", true});
    map.bindings.push_back({GLFW_KEY_HOME, "Home", Action::reset_camera, 0, "back to the first view of the scene"});
    map.bindings.push_back(
        {GLFW_KEY_ESCAPE, "Esc", Action::cancel_work, 0, "cancel what is being prepared; close what is open"});
    map.bindings.push_back({GLFW_KEY_F1, "F1", Action::show_help, 0, "this list"});
    map.bindings.push_back({GLFW_KEY_F2, "F2", Action::toggle_panel, 0, "hide or show the panel"});
}

KeyMap make_thesis() {
    const char* move = "move the camera in X and Z";
    const char* light = "move the light in X and Z";
    KeyMap map{"thesis", "Thesis", false, {}};
    map.bindings = {
        {GLFW_KEY_LEFT, "\u2190", Action::camera_left, 0, move},
        {GLFW_KEY_RIGHT, "\u2192", Action::camera_right, 0, move},
        {GLFW_KEY_UP, "\u2191", Action::camera_forward, 0, move},
        {GLFW_KEY_DOWN, "\u2193", Action::camera_back, 0, move},
        {GLFW_KEY_PAGE_UP, "PgUp", Action::camera_up, 0, "move the camera up, down"},
        {GLFW_KEY_PAGE_DOWN, "PgDn", Action::camera_down, 0, "move the camera up, down"},
        {GLFW_KEY_I, "I", Action::pitch_up, 0, "pitch the camera"},
        {GLFW_KEY_K, "K", Action::pitch_down, 0, "pitch the camera"},
        {GLFW_KEY_O, "O", Action::yaw_left, 0, "yaw the camera"},
        {GLFW_KEY_P, "P", Action::yaw_right, 0, "yaw the camera"},
        {GLFW_KEY_W, "W", Action::light_forward, 0, light},
        {GLFW_KEY_S, "S", Action::light_back, 0, light},
        {GLFW_KEY_A, "A", Action::light_left, 0, light},
        {GLFW_KEY_D, "D", Action::light_right, 0, light},
    };
    add_common(map);
    return map;
}

KeyMap make_viewer() {
    const char* walk = "walk";
    const char* light = "move the light in X and Z";
    KeyMap map{"viewer", "Viewer", true, {}};
    map.bindings = {
        {GLFW_KEY_W, "W", Action::camera_forward, 0, walk},
        {GLFW_KEY_A, "A", Action::camera_left, 0, walk},
        {GLFW_KEY_S, "S", Action::camera_back, 0, walk},
        {GLFW_KEY_D, "D", Action::camera_right, 0, walk},
        {GLFW_KEY_E, "E", Action::camera_up, 0, "rise, sink"},
        {GLFW_KEY_Q, "Q", Action::camera_down, 0, "rise, sink"},
        {GLFW_KEY_LEFT, "\u2190", Action::light_left, 0, light},
        {GLFW_KEY_RIGHT, "\u2192", Action::light_right, 0, light},
        {GLFW_KEY_UP, "\u2191", Action::light_forward, 0, light},
        {GLFW_KEY_DOWN, "\u2193", Action::light_back, 0, light},
        {GLFW_KEY_PAGE_UP, "PgUp", Action::light_up, 0, "move the light up, down"},
        {GLFW_KEY_PAGE_DOWN, "PgDn", Action::light_down, 0, "move the light up, down"},
    };
    add_common(map);
    return map;
}

}  // namespace

const KeyBinding* KeyMap::find(int key, bool ctrl) const {
    for (const KeyBinding& binding : bindings)
        if (binding.key == key && binding.ctrl == ctrl) return &binding;
    return nullptr;
}

const std::vector<KeyMap>& key_maps() {
    static const std::vector<KeyMap> maps = {make_thesis(), make_viewer()};
    return maps;
}

const KeyMap* find_key_map(const std::string& id) {
    for (const KeyMap& map : key_maps())
        if (id == map.id) return &map;
    return nullptr;
}

bool HeldKeys::any_held(const KeyMap& map) const {
    for (const int key : keys_) {
        const KeyBinding* binding = map.find(key);
        if (binding && is_held(binding->action)) return true;
    }
    return false;
}

float HeldKeys::value(const KeyMap& map, Action action) const {
    for (const int key : keys_) {
        const KeyBinding* binding = map.find(key);
        if (binding && binding->action == action) return 1.0f;
    }
    return 0.0f;
}

}  // namespace clarity::ui
