// key_map.hpp -- what the keys do, as data: presets of bindings, and the keys that are down.
#pragma once
#include <set>
#include <string>
#include <vector>

namespace clarity::ui {

enum class Action {
    // Held: they act for as long as the key is down.
    camera_left,
    camera_right,
    camera_forward,
    camera_back,
    camera_up,
    camera_down,
    pitch_up,
    pitch_down,
    yaw_left,
    yaw_right,
    light_left,
    light_right,
    light_forward,
    light_back,
    light_up,
    light_down,
    // Once a press.
    print_frame_rate,
    show_level,  // argument: level of the bounding volumes, 0 the root
    show_bottom_level,
    reset_camera,
    cancel_work,
    show_help,
    toggle_panel,
    undo,
    redo,
    open_file,
    save_picture,
    toggle_compare,
    swap_sides,
    toggle_inspector,
    toggle_lights,
    add_bookmark,
    next_bookmark,  // also the scene's own cameras
    frame_scene,    // all of it, or what is selected
};
inline bool is_held(Action action) {
    return action < Action::print_frame_rate;
}

struct KeyBinding {
    int key;  // GLFW's code, a place on the keyboard
    const char* name;
    Action action;
    int argument;
    const char* help;   // neighbours with the same text are shown as one line
    bool ctrl = false;  // only with Ctrl; the others only without
};

struct KeyMap {
    const char* id;
    const char* name;
    bool mouse_look;  // dragging turns the camera about itself; else it orbits the target
    std::vector<KeyBinding> bindings;
    const KeyBinding* find(int key, bool ctrl = false) const;
};

const std::vector<KeyMap>& key_maps();  // "thesis" first
// nullptr if there is none.
const KeyMap* find_key_map(const std::string& id);

// Keys that are down. Presses made while a text field has the keyboard never come here; releases always do.
class HeldKeys {
 public:
    void press(int key) { keys_.insert(key); }
    void release(int key) { keys_.erase(key); }
    void clear() { keys_.clear(); }
    bool any_held(const KeyMap& map) const;
    // 1 while a key of this action is down.
    float value(const KeyMap& map, Action action) const;

 private:
    std::set<int> keys_;
};

}  // namespace clarity::ui
