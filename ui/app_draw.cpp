// What App draws each frame: viewport at the left, panel at the right, status line at the bottom.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/app.hpp"
#include "ui/camera_control.hpp"
#include "ui/cards.hpp"
#include "ui/panel.hpp"
#include "ui/theme.hpp"

namespace clarity {

void App::draw() {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float scale = ui_scale();
    const float status = std::round(28 * scale);
    const float panel = state_.panel_visible ? std::round(std::min(372 * scale, size.x * 0.5f)) : 0;
    const Rect viewport{0, 0, std::max(size.x - panel, 1.0f), std::max(size.y - status, 1.0f)};
    draw_viewport(viewport);
    draw_empty_hint(viewport, *session_);
    if (state_.panel_visible)
        draw_panel({size.x - panel, 0, panel, viewport.height}, *session_, *overlay_, state_, window_->gl_text());
    draw_status_line({0, viewport.height, size.x, status}, *session_, *overlay_);
    draw_progress_card(viewport, *session_);
    draw_message_card(viewport, *session_, state_);
}

void App::draw_viewport(const Rect& area) {
    ImGui::SetNextWindowPos({area.x, area.y});
    ImGui::SetNextWindowSize({area.width, area.height});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
    ImGui::Begin("Viewport", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav |
                     ImGuiWindowFlags_NoScrollWithMouse);
    ImGui::PopStyleVar();
    const float margin = std::round(12 * ui_scale());
    const Rect room{area.x + margin, area.y + margin, std::max(area.width - 2 * margin, 1.0f),
                    std::max(area.height - 2 * margin, 1.0f)};
    const ImVec2 pixels = ImGui::GetIO().DisplayFramebufferScale;
    state_.room_width = static_cast<int>(room.width * pixels.x);
    state_.room_height = static_cast<int>(room.height * pixels.y);
    if (uploaded_ && texture_->name() != 0) {
        const float aspect = static_cast<float>(texture_->width()) / static_cast<float>(texture_->height());
        picture_area_ = letter_box(room, aspect);
        // Enlarged pixels stay sharp.
        const float zoom = picture_area_.width / static_cast<float>(texture_->width());
        texture_->set_magnified(zoom >= 2);
        const ImVec2 from(picture_area_.x, picture_area_.y), to(from.x + picture_area_.width, from.y + picture_area_.height);
        ImDrawList& list = *ImGui::GetWindowDrawList();
        list.AddImage(reinterpret_cast<ImTextureID>(static_cast<intptr_t>(texture_->name())), from, to);
        overlay_->draw(list, picture_area_, uploaded_->job.view.camera);
        ImGui::SetCursorScreenPos(from);
        ImGui::InvisibleButton(
            "picture", {picture_area_.width, picture_area_.height},
            ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonMiddle | ImGuiButtonFlags_MouseButtonRight);
        mouse_on_picture();
    }
    ImGui::End();
}

void App::mouse_on_picture() {
    const ImGuiIO& io = ImGui::GetIO();
    Camera& camera = session_->wish.camera;
    if (ImGui::IsItemHovered() && io.MouseWheel != 0) zoom_camera(camera, std::pow(0.88f, io.MouseWheel));
    if (!ImGui::IsItemActive() || (io.MouseDelta.x == 0 && io.MouseDelta.y == 0)) return;
    const float height = std::max(picture_area_.height, 1.0f);
    if (ImGui::IsMouseDown(ImGuiMouseButton_Middle) || ImGui::IsMouseDown(ImGuiMouseButton_Right)) {
        // What lies in the target's plane follows the mouse.
        float squared = 0;
        for (int i = 0; i < 3; ++i) squared += (camera.target[i] - camera.eye[i]) * (camera.target[i] - camera.eye[i]);
        const float pixel = 2 * std::tan(camera.fov_y_rad / 2) * std::sqrt(squared) / height;
        pan_camera(camera, -io.MouseDelta.x * pixel, io.MouseDelta.y * pixel);
    } else if (state_.key_map->mouse_look) {
        const float turn = camera.fov_y_rad / height;
        turn_camera(camera, -io.MouseDelta.x * turn, -io.MouseDelta.y * turn);
    } else {
        const float turn = 3.0f / height;
        orbit_camera(camera, -io.MouseDelta.x * turn, -io.MouseDelta.y * turn);
    }
}

}  // namespace clarity
