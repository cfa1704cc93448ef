#include "ui/widgets/key_map.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cctype>

namespace clarity::ui {
namespace {

// The key that a cap decides. GLFW's codes of these keys are ASCII.
int key_of_cap(const std::string& cap) {
    if (cap.size() != 1) return GLFW_KEY_UNKNOWN;  // nothing, or a sign outside of ASCII
    const auto sign = static_cast<unsigned char>(cap[0]);
    return std::isalnum(sign) || sign == ',' || sign == '.' ? std::toupper(sign) : GLFW_KEY_UNKNOWN;
}

bool types_something(int place) {
    return place > GLFW_KEY_SPACE && place <= GLFW_KEY_WORLD_2;
}

bool on_some_cap(int key, const Caps& caps) {
    for (int place = GLFW_KEY_SPACE + 1; place <= GLFW_KEY_WORLD_2; ++place)
        if (key_of_cap(caps(place)) == key) return true;
    return false;
}

int keypad_key(int place, bool num_lock) {
    static const int arrows[] = {GLFW_KEY_INSERT, GLFW_KEY_END,     GLFW_KEY_DOWN,  GLFW_KEY_PAGE_DOWN,
                                 GLFW_KEY_LEFT,   GLFW_KEY_UNKNOWN, GLFW_KEY_RIGHT, GLFW_KEY_HOME,
                                 GLFW_KEY_UP,     GLFW_KEY_PAGE_UP, GLFW_KEY_DELETE};  // 0 to 9, and the decimal point
    if (num_lock) return place <= GLFW_KEY_KP_9 ? GLFW_KEY_0 + (place - GLFW_KEY_KP_0) : place;
    return arrows[place - GLFW_KEY_KP_0];
}

}  // namespace

const KeyBinding* KeyMap::find(int key, bool ctrl) const {
    for (const KeyBinding& binding : bindings)
        if (binding.key == key && binding.ctrl == ctrl) return &binding;
    return nullptr;
}

const KeyMap* find_key_map(const std::string& id) {
    for (const KeyMap& map : key_maps())
        if (id == map.id) return &map;
    return nullptr;
}

bool HeldKeys::any_held(const KeyMap& map) const {
    for (const int key : keys_) {
        const KeyBinding* binding = map.find(key);
        if (binding && binding->motion != Motion::none) return true;
    }
    return false;
}

float HeldKeys::value(const KeyMap& map, Motion motion) const {
    for (const int key : keys_) {
        const KeyBinding* binding = map.find(key);
        if (binding && binding->motion == motion) return 1.0f;
    }
    return 0.0f;
}

std::string cap_in_force(int place) {
    const char* name = glfwGetKeyName(place, 0);
    return name ? name : "";
}

int meant_key(int place, bool num_lock, const Caps& caps) {
    if (place >= GLFW_KEY_KP_0 && place <= GLFW_KEY_KP_DECIMAL) return keypad_key(place, num_lock);
    if (!types_something(place)) return place;
    const int key = key_of_cap(caps(place));
    if (key != GLFW_KEY_UNKNOWN) return key;
    return on_some_cap(place, caps) ? GLFW_KEY_UNKNOWN : place;
}

std::string name_on_cap(int key, const std::string& name, const Caps& caps) {
    // Where caps have no Latin letters or unshifted digits, keyboards bear those besides.
    if (!types_something(key) || std::isalnum(key) || on_some_cap(key, caps)) return name;
    const std::string cap = caps(key);
    return cap.empty() ? name : cap;
}

}  // namespace clarity::ui
