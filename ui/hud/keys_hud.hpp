// keys_hud.hpp -- the list of keys, of all key maps, over the picture.
#pragma once
#include <string>
#include <vector>

#include "ui/app/ui_state.hpp"
#include "ui/viewport/viewport.hpp"

namespace clarity::ui {

// One line of the list: the keys of each map, in the order of key_maps().
struct KeyLine {
    std::vector<std::string> keys;
    std::string help;
};
std::vector<KeyLine> key_lines();

// While UiState::keys_open; a click beside it closes it.
void draw_keys_hud(const Rect& area, UiState& state);
// The table of them, for a tab or a card; the map that is in use stands out.
void draw_key_table(const UiState& state);

}  // namespace clarity::ui
