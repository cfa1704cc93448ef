// The parts of App which draw a frame: viewport at the left, panel at the right, status line at the bottom.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/app/app.hpp"
#include "ui/browser/file_browser.hpp"
#include "ui/hud/hud.hpp"
#include "ui/hud/keys_hud.hpp"
#include "ui/panel/panel.hpp"
#include "ui/viewport/timeline.hpp"
#include "ui/widgets/theme.hpp"

namespace clarity::ui {

void App::draw() {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float scale = ui_scale();
    const float status = std::round(28 * scale);
    const float panel = state_.panel_visible ? std::round(std::min(state_.panel_width * scale, size.x * 0.6f)) : 0;
    const float left = std::max(size.x - panel, 1.0f), above = std::max(size.y - status, 1.0f);
    const float timeline = std::min(timeline_height(*session_, left), above - 1);
    const Rect viewport{0, 0, left, above - timeline};
    pane_->draw(viewport, *session_, *overlay_, state_);
    draw_empty_hint(viewport, *session_);
    if (state_.panel_visible) draw_panel({size.x - panel, 0, panel, above}, *session_, *overlay_, state_, window_->gl_text());
    draw_timeline({0, viewport.height, left, timeline}, *session_);
    draw_status_line({0, above, size.x, status}, *session_, *overlay_, state_);
    draw_progress_hud(viewport, *session_);
    draw_message_hud(viewport, *session_, state_);
    draw_file_browser(viewport, *session_, state_);
    draw_keys_hud({0, 0, left, above}, state_);
}

void App::upload_preview() {
    const auto preview = session_->preview();
    if (preview == uploaded_preview_) return;
    uploaded_preview_ = preview;
    const bool has_image = preview && preview->image.width > 0;
    if (!preview_) preview_ = std::make_unique<PictureTexture>();
    state_.preview_texture = has_image && !preview_->upload(preview->image) ? preview_->name() : 0;
}

void App::upload_picture() {
    upload_preview();
    const auto picture = session_->picture();
    if (!picture || picture == uploaded_) return;
    if (const Problem why = pane_->upload(picture)) session_->messages().report(why.text());
    uploaded_ = picture;
    std::string title = "Clarity";
    if (const auto files = session_->files(); !files.empty())
        title = files.front().substr(files.front().find_last_of('/') + 1) + " - Clarity";
    window_->set_title(title);
}

}  // namespace clarity::ui
