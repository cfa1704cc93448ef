// key_actions.hpp -- what single keys do, where that is more than a call (the table is in key_table.cpp).
#pragma once
#include "ui/widgets/key_map.hpp"

namespace clarity::ui {

void print_frame_rate(KeyTarget& to);  // to stdout
void toggle_inspector(KeyTarget& to);
void add_bookmark(KeyTarget& to);
void go_to_next_bookmark(KeyTarget& to);  // the scene's own cameras come first
// Closes what lies over the picture, if anything does. Otherwise stops the work that is under way.
void toggle_playing(KeyTarget& to);
void close_or_cancel(KeyTarget& to);

}  // namespace clarity::ui
