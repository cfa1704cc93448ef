#include "ui/overlay.hpp"

#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "base/log.hpp"
#include "ui/camera_control.hpp"
#include "ui/theme.hpp"

namespace clarity {
namespace {

constexpr float kTwoPi = 6.2831853f;

glm::vec3 vec(const Vec3& a) {
    return {a[0], a[1], a[2]};
}

// World space to the pixels of a rectangle, for lines that may pass behind the eye.
class Projection {
 public:
    Projection(const Rect& area, const Camera& camera) : area_(area) {
        const CameraAxes axes = camera_axes(camera);
        eye_ = vec(camera.eye);
        right_ = vec(axes.right);
        up_ = vec(axes.up);
        forward_ = vec(axes.forward);
        half_height_ = std::tan(camera.fov_y_rad / 2);
        near_ = 1e-3f * glm::length(vec(camera.target) - eye_);
    }
    const glm::vec3& eye() const { return eye_; }

    // Depth along the line of sight in z.
    glm::vec3 to_camera(const glm::vec3& p) const {
        const glm::vec3 d = p - eye_;
        return {glm::dot(d, right_), glm::dot(d, up_), glm::dot(d, forward_)};
    }
    ImVec2 to_screen(const glm::vec3& c) const {
        const float scale = area_.height / (2 * half_height_ * c.z);
        return {area_.x + area_.width / 2 + c.x * scale, area_.y + area_.height / 2 - c.y * scale};
    }
    void line(ImDrawList& list, glm::vec3 a, glm::vec3 b, ImU32 color, float width) const {
        a = to_camera(a);
        b = to_camera(b);
        if (a.z < near_ && b.z < near_) return;
        if (a.z < near_) std::swap(a, b);
        if (b.z < near_) b = a + (b - a) * ((a.z - near_) / (a.z - b.z));
        const ImVec2 p = to_screen(a), q = to_screen(b);
        // Far outside, ImGui's own clipping loses precision; wholly outside, there is nothing to draw.
        if (std::max(p.x, q.x) < area_.x || std::min(p.x, q.x) > area_.x + area_.width) return;
        if (std::max(p.y, q.y) < area_.y || std::min(p.y, q.y) > area_.y + area_.height) return;
        list.AddLine(p, q, color, width);
    }

 private:
    Rect area_;
    glm::vec3 eye_, right_, up_, forward_;
    float half_height_ = 1, near_ = 0;
};

// Corners whose numbers differ in one bit share an edge.
void draw_box(ImDrawList& list, const Projection& projection, const std::array<std::array<float, 3>, 8>& corners, ImU32 color,
              float width) {
    for (unsigned corner = 0; corner < 8; ++corner)
        for (unsigned bit = 1; bit < 8; bit <<= 1)
            if (!(corner & bit)) projection.line(list, vec(corners[corner]), vec(corners[corner | bit]), color, width);
}

void draw_circle(ImDrawList& list, const Projection& projection, const glm::vec3& center, const glm::vec3& a,
                 const glm::vec3& b, int segments, ImU32 color, float width) {
    glm::vec3 last = center + a;
    for (int i = 1; i <= segments; ++i) {
        const float angle = kTwoPi * static_cast<float>(i) / static_cast<float>(segments);
        const glm::vec3 next = center + a * std::cos(angle) + b * std::sin(angle);
        projection.line(list, last, next, color, width);
        last = next;
    }
}

// Three great circles, faint, and the outline that the eye sees.
void draw_sphere(ImDrawList& list, const Projection& projection, const std::array<float, 4>& sphere, int segments, ImU32 color,
                 ImU32 faint, float width) {
    const glm::vec3 center(sphere[0], sphere[1], sphere[2]);
    const float r = sphere[3];
    const glm::vec3 x(r, 0, 0), y(0, r, 0), z(0, 0, r);
    draw_circle(list, projection, center, x, y, segments, faint, width);
    draw_circle(list, projection, center, y, z, segments, faint, width);
    draw_circle(list, projection, center, z, x, segments, faint, width);
    const glm::vec3 to_eye = projection.eye() - center;
    const float distance = glm::length(to_eye);
    if (distance <= r * 1.001f) return;  // the eye is inside: no outline
    // The outline is the circle of points whose tangent planes hold the eye.
    const glm::vec3 axis = to_eye / distance;
    const glm::vec3 side = glm::normalize(glm::cross(axis, std::abs(axis.x) < 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0)));
    const float outline = r * std::sqrt(1 - (r / distance) * (r / distance));
    draw_circle(list, projection, center + axis * (r * r / distance), side * outline, glm::cross(axis, side) * outline,
                segments, color, width);
}

}  // namespace

void VolumeOverlay::toggle(rt_u32 level) {
    if (level_ == level)
        level_.reset();
    else
        level_ = level;
}

void VolumeOverlay::update(const std::shared_ptr<const Prepared>& prepared) {
    if (fetching_.valid()) {
        if (fetching_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
        try {
            volumes_ = fetching_.get();
        } catch (const std::exception& error) {
            log(LogLevel::warning, std::string("bounding volumes: ") + error.what());
            volumes_.reset();
        }
    }
    if (!prepared || !level_) {
        volumes_.reset();
        accel_.reset();
        fetched_.reset();
        return;
    }
    if (accel_ == prepared->accel && fetched_ == level_) return;
    accel_ = prepared->accel;
    fetched_ = level_;
    fetching_ = std::async(std::launch::async, [accel = accel_, level = *level_, wake = wake_] {
        auto volumes = std::make_shared<Volumes>(accel_volumes(*accel, level, kLimit));
        wake();
        return Result(std::move(volumes));
    });
}

void VolumeOverlay::draw(ImDrawList& list, const Rect& area, const Camera& camera) const {
    if (!volumes_ || !level_) return;
    const Projection projection(area, camera);
    // The more there are, the fainter and the plainer.
    const size_t shown = std::max<size_t>(count(), 1);
    const float strength = std::clamp(6.0f / std::sqrt(static_cast<float>(shown)), 0.22f, 1.0f);
    const float width = (shown < 64 ? 1.6f : 1.0f) * ui_scale();
    const ImVec4& amber = colors::kAmber;
    const ImU32 color = ImGui::GetColorU32(ImVec4(amber.x, amber.y, amber.z, strength));
    const ImU32 faint = ImGui::GetColorU32(ImVec4(amber.x, amber.y, amber.z, strength * 0.4f));
    const int segments = std::clamp(static_cast<int>(16000 / shown), 10, 64);
    list.PushClipRect({area.x, area.y}, {area.x + area.width, area.y + area.height}, true);
    for (const auto& box : volumes_->boxes) draw_box(list, projection, box, color, width);
    for (const auto& sphere : volumes_->spheres) draw_sphere(list, projection, sphere, segments, color, faint, width);
    list.PopClipRect();
}

}  // namespace clarity
