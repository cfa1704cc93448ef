#include "ui/widgets/key_map.hpp"

namespace clarity::ui {

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

}  // namespace clarity::ui
