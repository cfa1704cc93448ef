// hud.hpp -- HUD over and under the picture: progress with a cancel button, the last failure, the status line.
#pragma once
#include "ui/overlay/overlay.hpp"
#include "ui/session/session.hpp"
#include "ui/widgets/ui_state.hpp"

namespace clarity::ui {

void draw_progress_hud(const Rect& viewport, Session& session);
void draw_message_hud(const Rect& viewport, Session& session, UiState& state);
void draw_empty_hint(const Rect& viewport, const Session& session);
void draw_status_line(const Rect& area, Session& session, const VolumeOverlay& overlay, const UiState& state);

}  // namespace clarity::ui
