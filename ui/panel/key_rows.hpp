// key_rows.hpp -- rows of the panel for keys of lights and materials.
#pragma once
#include <array>

#include "scene/key.hpp"

namespace clarity::ui {

// Draws label and widget of a key. Returns whether the user has changed the value, which is then allowed. size: of the scene,
// for steps of places and lengths.
bool key_row(const Key& key, std::array<float, 3>& value, float size);

}  // namespace clarity::ui
