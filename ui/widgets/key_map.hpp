// key_map.hpp -- key bindings as data: presets of bindings, and the set of keys that are down.
#pragma once
#include <set>
#include <string>
#include <vector>

namespace clarity::ui {

enum class Action {
    // Held actions: they last while the key is down.
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
    // Single actions: once for each press.
    print_frame_rate,
    show_level,  // argument: level of the bounding volumes, 0 is the root
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
    next_bookmark,  // bookmarks and the scene's own cameras
    frame_scene,    // the selection, or the whole scene if nothing is selected
};
inline bool is_held(Action action) {
    return action < Action::print_frame_rate;
}

// What one key does in one key map.
struct KeyBinding {
    int key;  // GLFW's key code: a position on the keyboard
    const char* name;
    Action action;
    int argument;
    const char* help;   // the help lists neighbouring bindings with equal text in one line
    bool ctrl = false;  // true: only with Ctrl; false: only without
};

// A preset of bindings.
struct KeyMap {
    const char* id;
    const char* name;
    bool mouse_look;  // true: dragging turns the camera about itself; false: dragging orbits the target
    std::vector<KeyBinding> bindings;
    const KeyBinding* find(int key, bool ctrl = false) const;
};

const std::vector<KeyMap>& key_maps();  // "thesis" first
// Returns nullptr if no key map has this id.
const KeyMap* find_key_map(const std::string& id);

// The keys that are down. Presses are not added while a text field has the keyboard; releases always count.
class HeldKeys {
 public:
    void press(int key) { keys_.insert(key); }
    void release(int key) { keys_.erase(key); }
    void clear() { keys_.clear(); }
    bool any_held(const KeyMap& map) const;
    // 1 while a key of this action is down, otherwise 0.
    float value(const KeyMap& map, Action action) const;

 private:
    std::set<int> keys_;
};

}  // namespace clarity::ui
