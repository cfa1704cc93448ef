// file_browser.hpp -- choosing files within the window: with the mouse, or by typing with completion.
#pragma once
#include "ui/app/ui_state.hpp"
#include "ui/session/session.hpp"
#include "ui/viewport/viewport.hpp"

namespace clarity::ui {

// While UiState::browser_open. Folders are read on a thread of their own: a slow disk does not hold the window up.
void draw_file_browser(const Rect& area, Session& session, UiState& state);

}  // namespace clarity::ui
