#include "ui/viewport/picture_mouse.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "scene/light_kinds.hpp"
#include "ui/session/camera_control.hpp"
#include "ui/session/session_view.hpp"
#include "ui/widgets/theme.hpp"

namespace clarity::ui {
namespace {

constexpr float kClickSlack = 4;      // units of the window that the mouse may move within a click
constexpr float kFocusNearer = 0.7f;  // a double click multiplies the distance by this

glm::vec2 vec(const ImVec2& a) {
    return {a.x, a.y};
}

const Camera& camera_of(const Picture& picture) {
    return picture.job.view.camera;
}

}  // namespace

void PictureMouse::find_hovered(const Target& target, const glm::vec2& mouse, bool hovered) {
    hover_.reset();
    hovered_light_ = -1;
    wipe_hovered_ = false;
    if (grab_ != Grab::instance) move_handle_ = MoveHandle::none;
    if (!hovered) return;
    const ByteImage& image = target.picture.main.image;
    for (size_t i = 0; i < target.places.size() && !hover_; ++i) {
        Hover hover{i, 0, 0};
        const Rect& shown = target.places[i].shown;
        if (shown.holds(mouse.x, mouse.y) &&
            pixel_at(target.places[i].area, mouse, image.width, image.height, hover.x, hover.y))
            hover_ = hover;
    }
    float nearest = target.handle_radius;
    for (const LightHandle& handle : target.handles)
        if (const float away = glm::length(handle.place - mouse); away <= nearest) {
            nearest = away;
            hovered_light_ = static_cast<int>(handle.index);
        }
    if (target.move && hovered_light_ < 0 && grab_ == Grab::nothing) move_handle_ = handle_at(*target.move, mouse, ui_scale());
    if (target.wipe && hovered_light_ < 0 && move_handle_ == MoveHandle::none) {
        const Rect& right = target.places.back().shown;
        wipe_hovered_ = std::abs(mouse.x - right.x) <= 7 * ui_scale() && mouse.y >= right.y && mouse.y < right.y + right.height;
    }
}

void PictureMouse::press(const Target& target, Session& session, const glm::vec2& mouse) {
    pressed_ = last_ = mouse;
    moved_ = false;
    double_ = ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
    button_ = ImGui::IsMouseDown(ImGuiMouseButton_Right)    ? ImGuiMouseButton_Right
              : ImGui::IsMouseDown(ImGuiMouseButton_Middle) ? ImGuiMouseButton_Middle
                                                            : ImGuiMouseButton_Left;
    grab_ = Grab::camera;
    offset_ = {0, 0};
    if (button_ != ImGuiMouseButton_Left) return;
    if (ImGui::GetIO().KeyCtrl) {
        grab_ = Grab::part;
        part_area_ = target.places[hover_ ? hover_->place : 0].area;
    } else if (hovered_light_ >= 0) {
        grab_ = Grab::light;
        light_ = static_cast<unsigned>(hovered_light_);
        session.selected_light = light_;
        for (const LightHandle& handle : target.handles)
            if (handle.index == light_) offset_ = handle.place - mouse;
    } else if (target.move && move_handle_ != MoveHandle::none && session.selection.instance >= 0) {
        grab_ = Grab::instance;
        moved_instance_ = static_cast<rt_u32>(session.selection.instance);
        move_drag_ = {move_handle_, mouse, target.move->middle, session.desired.instances.shift_of(moved_instance_)};
    } else if (wipe_hovered_) {
        grab_ = Grab::wipe;
        offset_.x = target.places.back().shown.x - mouse.x;
    }
}

void PictureMouse::drag_camera(const Rect& area, Camera& camera, bool look, const glm::vec2& moved) const {
    const float height = std::max(area.height, 1.0f);
    if (button_ != ImGuiMouseButton_Left) {
        // A point in the target's plane follows the mouse.
        float squared = 0;
        for (int i = 0; i < 3; ++i) squared += (camera.target[i] - camera.eye[i]) * (camera.target[i] - camera.eye[i]);
        const float unit = 2 * std::tan(camera.fov_y_rad / 2) * std::sqrt(squared) / height;
        pan_camera(camera, -moved.x * unit, moved.y * unit);
    } else if (look) {
        const float turn = camera.fov_y_rad / height;
        turn_camera(camera, -moved.x * turn, -moved.y * turn);
    } else {
        const float turn = 3.0f / height;
        orbit_camera(camera, -moved.x * turn, -moved.y * turn);
    }
}

void PictureMouse::drag(const Target& target, Session& session, UiState& state, const glm::vec2& mouse,
                        const glm::vec2& moved) {
    const Rect& area = target.places.front().area;
    switch (grab_) {
        case Grab::camera:
            drag_camera(area, session.desired.camera, state.key_map->mouse_look, moved);
            break;
        case Grab::wipe:
            state.wipe = std::clamp((mouse.x + offset_.x - area.x) / std::max(area.width, 1.0f), 0.0f, 1.0f);
            break;
        case Grab::light: {
            if (light_ >= session.desired.lights.size()) break;
            rt_light& light = session.desired.lights[light_].values;
            const Projection projection(area, camera_of(target.picture));
            if (!light_kind_of(light).has_place)
                drag_sun(light, projection, mouse + offset_);
            else if (ImGui::GetIO().KeyShift)
                push_point_light(light, projection, std::exp(-moved.y * 0.006f / ui_scale()));
            else
                drag_point_light(light, projection, mouse + offset_);
            make_sound(light, true);
            break;
        }
        case Grab::instance:
            session.desired.instances.set_shift(moved_instance_,
                                                dragged(move_drag_, Projection(area, camera_of(target.picture)), mouse));
            break;
        case Grab::part:
            draw_part(mouse);
            break;
        case Grab::nothing:
            break;
    }
}

// A rectangle from where the button was pressed to the mouse, within the picture.
void PictureMouse::draw_part(const glm::vec2& mouse) {
    const glm::vec2 first(part_area_.x, part_area_.y), last(part_area_.x + part_area_.width, part_area_.y + part_area_.height);
    const glm::vec2 a = glm::clamp(pressed_, first, last), b = glm::clamp(mouse, first, last);
    const glm::vec2 corner = glm::min(a, b), size = glm::abs(b - a);
    drawn_part_ = {corner.x, corner.y, size.x, size.y};
}

void PictureMouse::take_part(Session& session) {
    const Rect drawn = *drawn_part_;
    drawn_part_.reset();
    if (drawn.width > 0 && drawn.height > 0)
        session.desired.part = {(drawn.x - part_area_.x) / part_area_.width, (drawn.y - part_area_.y) / part_area_.height,
                                drawn.width / part_area_.width, drawn.height / part_area_.height};
}

void PictureMouse::click(const Target& target, Session& session, UiState& state) {
    if (grab_ != Grab::camera || !hover_ || button_ == ImGuiMouseButton_Middle) return;
    if (button_ == ImGuiMouseButton_Right || ImGui::GetIO().KeyShift) {
        rays_asked_ = true;
        state.selected_ray = -1;
        state.tab = Tab::inspect;
        state.tab_asked = true;
        session.inspect(hover_->x, hover_->y);
        return;
    }
    if (double_) {
        focus_on_ = hover_;
        focus_after_ = session.inspector().latest() ? session.inspector().latest()->request : 0;
        if (const auto& distance = target.picture.main.distance; distance && !distance->pixels.empty()) {
            const float t = distance->pixels[size_t{hover_->y} * distance->width + hover_->x];
            const Projection projection(target.places[hover_->place].area, camera_of(target.picture));
            const glm::vec3 point = projection.eye() + projection.ray(last_) * t;
            if (std::isfinite(t)) focus_on(session.desired, {point.x, point.y, point.z}, kFocusNearer);
            focus_on_.reset();
        } else {
            session.inspect(hover_->x, hover_->y);
        }
        return;
    }
    rays_asked_ = false;
    session.pick(hover_->x, hover_->y);
}

void PictureMouse::focus_when_known(Session& session) {
    if (!focus_on_) return;
    const auto inspection = session.inspector().latest();
    if (!inspection || inspection->request <= focus_after_) return;
    if (inspection->x != focus_on_->x || inspection->y != focus_on_->y) {
        if (!session.inspector().busy()) focus_on_.reset();  // another pixel was requested meanwhile
        return;
    }
    focus_on_.reset();
    if (!inspection->failure.empty() || inspection->result.rays.empty()) return;
    const RayRecord& ray = inspection->result.rays.front();
    if (!std::isfinite(ray.t)) return;
    std::array<float, 3> point;
    for (size_t i = 0; i < 3; ++i) point[i] = ray.origin[i] + ray.direction[i] * ray.t;
    focus_on(session.desired, point, kFocusNearer);
}

void PictureMouse::update(const Target& target, Session& session, UiState& state) {
    const ImGuiIO& io = ImGui::GetIO();
    const glm::vec2 mouse = vec(io.MousePos);
    const bool hovered = ImGui::IsItemHovered(), active = ImGui::IsItemActive();
    find_hovered(target, mouse, hovered || active);
    if (ImGui::IsItemActivated()) press(target, session, mouse);
    if (active && grab_ != Grab::nothing) {
        if (!moved_ && glm::length(mouse - pressed_) > kClickSlack * ui_scale()) moved_ = true;
        if (moved_ && mouse != last_) {
            drag(target, session, state, mouse, mouse - last_);
            last_ = mouse;
        }
    }
    if (ImGui::IsItemDeactivated()) {
        if (!moved_ && grab_ != Grab::nothing) click(target, session, state);
        if (drawn_part_) take_part(session);
        grab_ = Grab::nothing;
    }
    focus_when_known(session);
    if (hovered && io.MouseWheel != 0) zoom_camera(session.desired.camera, std::pow(0.88f, io.MouseWheel));

    const bool resting = hovered && !active;
    if (resting && state.inspect_hover && hover_) {
        const bool same = inspected_hover_ && inspected_hover_->x == hover_->x && inspected_hover_->y == hover_->y &&
                          hover_revision_ == target.picture.job.revision;
        if (!same) {
            session.inspect(hover_->x, hover_->y);
            inspected_hover_ = hover_;
            hover_revision_ = target.picture.job.revision;
            state.selected_ray = -1;
        }
    }
    if (grab_ == Grab::wipe || (resting && wipe_hovered_))
        ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    else if (grab_ == Grab::light || grab_ == Grab::instance ||
             (resting && (hovered_light_ >= 0 || move_handle_ != MoveHandle::none)))
        ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
    else if (active && moved_ && button_ != ImGuiMouseButton_Left)
        ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeAll);
}

}  // namespace clarity::ui
