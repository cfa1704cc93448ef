// keyboard_layout.hpp -- which key is meant in the user's keyboard layout. GLFW names a key by its place on a US keyboard; a
// user means the letter on its cap.
#pragma once
#include <functional>
#include <string>

namespace clarity::ui {

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
