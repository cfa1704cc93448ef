// panel.hpp -- the tabs beside the picture. Each draws its rows from tables and statistics, and changes the session's desired
// state.
#pragma once
#include <array>

#include "scene/key.hpp"
#include "ui/overlay/overlay.hpp"
#include "ui/session/session.hpp"
#include "ui/widgets/ui_state.hpp"

namespace clarity::ui {

void draw_panel(const Rect& area, Session& session, VolumeOverlay& overlay, UiState& state, const std::string& gl_text);

void draw_toolbar(Session& session, VolumeOverlay& overlay, UiState& state);
void draw_render_tab(Session& session, VolumeOverlay& overlay, UiState& state);
void draw_output_rows(Session& session, UiState& state);  // in the Render tab: presets, pictures, sequences
void draw_scene_tab(Session& session, UiState& state);
void draw_scene_tree(Session& session, UiState& state);
void draw_material_rows(Session& session, UiState& state);
void draw_texture_rows(Session& session, UiState& state, rt_u32 material);
void draw_object_rows(Session& session, UiState& state);
void draw_light_rows(Session& session, UiState& state);
void draw_sky_rows(Session& session);
void draw_bookmark_rows(Session& session, UiState& state);
void draw_inspect_tab(Session& session, UiState& state);
void draw_noise_rows(Session& session, UiState& state, unsigned x, unsigned y);  // why that pixel is noisy
void draw_sampler_rows(const SamplerPoints& points, UiState& state);
void draw_statistics_tab(Session& session);
void draw_log_tab(Session& session, UiState& state);
void draw_plugins_tab(Session& session);
void draw_help_tab(UiState& state, const std::string& gl_text);

// Rows of the panel for keys of lights and materials.

// Draws label and widget of a key. Returns whether the user has changed the value, which is then allowed. size: of the scene,
// for steps of places and lengths.
bool key_row(const Key& key, std::array<float, 3>& value, float size);

}  // namespace clarity::ui
