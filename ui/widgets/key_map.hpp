// key_map.hpp -- key bindings as data: presets of bindings, the set of keys that are down, and which key is meant
// in the user's layout.
#pragma once
#include <functional>
#include <set>
#include <string>
#include <vector>

namespace clarity::ui {

class Session;
class VolumeOverlay;
struct UiState;

// What a key moves while it is down.
enum class Motion {
    none,
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
};

// What a press of a key acts on.
struct KeyTarget {
    Session& session;
    UiState& state;
    VolumeOverlay& overlay;
};

// What one key does in one key map: either it moves something while it is down, or it does something once for each press.
struct KeyBinding {
    int key;  // GLFW's key code; for a letter that of the key with this letter on its cap
    const char* name;
    const char* help;  // the help lists neighbouring bindings with equal text in one line
    Motion motion = Motion::none;
    void (*press)(KeyTarget&) = nullptr;
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

// All key maps, "thesis" first. The table is in ui/app/key_table.cpp, because its rows act on session and overlay.
const std::vector<KeyMap>& key_maps();
// Returns nullptr if no key map has this id.
const KeyMap* find_key_map(const std::string& id);

// The keys that are down. Presses are not added while a text field has the keyboard; releases always count.
class HeldKeys {
 public:
    void press(int key) { keys_.insert(key); }
    void release(int key) { keys_.erase(key); }
    void clear() { keys_.clear(); }
    bool any_held(const KeyMap& map) const;
    // 1 while a key of this motion is down, otherwise 0.
    float value(const KeyMap& map, Motion motion) const;

 private:
    std::set<int> keys_;
};

// Which key is meant in the user's keyboard layout. GLFW names a key by its place on a US keyboard; a
// user means the letter on its cap.

// Returns what is on the cap of the key at a place (GLFW's key code), without Shift; empty if it types nothing.
using Caps = std::function<std::string(int place)>;
std::string cap_in_force(int place);  // in the layout that is in force now

// Returns the key (GLFW's key code) that is meant by the key at `place`. A Latin letter, a digit, a comma or a period on its
// cap decides. Without one, the key is what a US keyboard has at its place, unless another cap bears that: so letters work in
// layouts that have none (Russian, Greek), and the row of digits where digits need Shift (AZERTY). GLFW_KEY_UNKNOWN: it means
// nothing. Keys that type nothing are themselves. The keypad has digits with num_lock, otherwise arrows.
int meant_key(int place, bool num_lock, const Caps& caps = cap_in_force);

// Returns the name of a key for people: `name`, unless no cap bears it and the key at its US place shows another sign.
std::string name_on_cap(int key, const std::string& name, const Caps& caps = cap_in_force);

}  // namespace clarity::ui
