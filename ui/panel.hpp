// panel.hpp -- the tabs beside the picture. Each draws from tables and statistics, and changes the session's wish.
#pragma once
#include "ui/overlay.hpp"
#include "ui/session.hpp"
#include "ui/ui_state.hpp"

namespace clarity {

void draw_panel(const Rect& area, Session& session, VolumeOverlay& overlay, UiState& state, const std::string& gl_text);

void draw_render_tab(Session& session, VolumeOverlay& overlay, const UiState& state);
void draw_scene_tab(Session& session, UiState& state);
void draw_statistics_tab(Session& session);
void draw_log_tab(Session& session);
void draw_plugins_tab(Session& session);
void draw_help_tab(UiState& state, const std::string& gl_text);

}  // namespace clarity
