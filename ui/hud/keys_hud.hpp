// keys_hud.hpp -- the list of keys of all key maps, over the picture.
#pragma once
#include <string>
#include <vector>

#include "ui/widgets/rect.hpp"
#include "ui/widgets/ui_state.hpp"

namespace clarity::ui {

// One line of the list: a help text and its keys in each map, in the order of key_maps().
struct KeyLine {
    std::vector<std::string> keys;
    std::string help;
};
std::vector<KeyLine> key_lines();

// Draws the list while UiState::keys_open. A click beside it closes it.
void draw_keys_hud(const Rect& area, UiState& state);
// Draws the list as a table, for a tab or a box. The current key map is highlighted.
void draw_key_table(const UiState& state);

}  // namespace clarity::ui
