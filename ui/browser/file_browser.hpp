// file_browser.hpp -- the file browser in the window: choose with the mouse, or type with completion.
#pragma once
#include "ui/session/session.hpp"
#include "ui/widgets/rect.hpp"
#include "ui/widgets/ui_state.hpp"

namespace clarity::ui {

// Draws the browser while UiState::browser_open. Folders are read on a separate thread, so that a slow disk does not block the
// window.
void draw_file_browser(const Rect& area, Session& session, UiState& state);
// To be called before the window goes.
void stop_file_browser();

}  // namespace clarity::ui
