#include "ui/overlay/line_quads.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace clarity::ui {
namespace {

constexpr float kShortest = 0.25f;  // pixels; shorter lines are omitted

struct Place {
    float x, y, inv_depth;
};

Place mix(const Place& a, const Place& b, float t) {
    return {a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t, a.inv_depth + (b.inv_depth - a.inv_depth) * t};
}

// Clips a line to 0..width, 0..height, widened by `margin` (Liang and Barsky 1984). Returns false if nothing is left.
bool clip(Place& a, Place& b, float width, float height, float margin) {
    float from = 0, to = 1;
    const float dx = b.x - a.x, dy = b.y - a.y;
    const float towards[] = {-dx, dx, -dy, dy};
    const float room[] = {a.x + margin, width + margin - a.x, a.y + margin, height + margin - a.y};
    for (int i = 0; i < 4; ++i) {
        if (towards[i] == 0) {
            if (room[i] < 0) return false;
        } else if (towards[i] < 0) {
            from = std::max(from, room[i] / towards[i]);
        } else {
            to = std::min(to, room[i] / towards[i]);
        }
    }
    if (!(from < to)) return false;
    const Place first = a;
    if (to < 1) b = mix(first, b, to);
    if (from > 0) a = mix(first, Place(b), to > 0 ? from / to : 0);
    return true;
}

// The part of a projection which maps to pixels of the screen.
class Screen {
 public:
    Screen(const Projection& projection, float scale)
        : projection_(projection),
          scale_(scale),
          width_(projection.area().width * scale),
          height_(projection.area().height * scale) {}
    float width() const { return width_; }
    float height() const { return height_; }

    // Projects and clips a line to the screen, widened by `margin`. Returns false if nothing is left.
    bool place(const Line& line, float margin, Place& p, Place& q) const {
        const float near = projection_.near();
        glm::vec3 a = projection_.to_camera(line.a), b = projection_.to_camera(line.b);
        if (!(std::max(a.z, b.z) > near)) return false;
        if (a.z < near) a = b + (a - b) * ((b.z - near) / (b.z - a.z));
        if (b.z < near) b = a + (b - a) * ((a.z - near) / (a.z - b.z));
        p = at(a, near);
        q = at(b, near);
        return clip(p, q, width_, height_, margin);
    }
    float distance(const Place& p) const {
        const glm::vec2 slope = (glm::vec2(p.x / width_, p.y / height_) * 2.0f - 1.0f) * projection_.half_size();
        return std::sqrt(1 + glm::dot(slope, slope)) / p.inv_depth;
    }

 private:
    Place at(glm::vec3 camera, float near) const {
        camera.z = std::max(camera.z, near);
        const Rect& area = projection_.area();
        const glm::vec2 window = projection_.to_window(camera);
        return {(window.x - area.x) * scale_, (window.y - area.y) * scale_, 1 / camera.z};
    }

    const Projection& projection_;
    float scale_, width_, height_;
};

bool is_behind(const Screen& screen, const FloatImage& distance, const Place& p) {
    const auto texel = [](float at, float size, unsigned count) {
        return static_cast<unsigned>(std::clamp(at / size * static_cast<float>(count), 0.0f, static_cast<float>(count - 1)));
    };
    const unsigned x = texel(p.x, screen.width(), distance.width), y = texel(p.y, screen.height(), distance.height);
    return screen.distance(p) > distance.pixels[size_t{y} * distance.width + x] * (1 + kDistancePlay);
}

}  // namespace

void append_quads(const LineList& lines, const Projection& projection, float scale, std::vector<LineVertex>& vertices) {
    const Screen screen(projection, scale);
    vertices.reserve(vertices.size() + lines.size() * 4);
    for (const Line& line : lines.lines()) {
        const float half = std::max(line.width * scale, 1.0f) / 2, reach = half + 0.5f;
        Place p, q;
        if (!screen.place(line, reach, p, q)) continue;
        const float dx = q.x - p.x, dy = q.y - p.y, length = std::sqrt(dx * dx + dy * dy);
        if (!(length > kShortest)) continue;
        const float nx = -dy / length * reach, ny = dx / length * reach;
        vertices.push_back({p.x - nx, p.y - ny, p.inv_depth, -reach, half, line.color});
        vertices.push_back({p.x + nx, p.y + ny, p.inv_depth, reach, half, line.color});
        vertices.push_back({q.x - nx, q.y - ny, q.inv_depth, -reach, half, line.color});
        vertices.push_back({q.x + nx, q.y + ny, q.inv_depth, reach, half, line.color});
    }
}

void append_thin(const LineList& lines, const Projection& projection, float scale, const ThinLines& thin,
                 std::vector<LineVertex>& vertices) {
    constexpr float kShort = 24;  // pixels; a longer line is probably in front of the surface somewhere
    const Screen screen(projection, scale);
    const bool tested = thin.distance && !thin.distance->pixels.empty();
    vertices.reserve(vertices.size() + lines.size() * 2);
    for (const Line& line : lines.lines()) {
        Place p, q;
        if (!screen.place(line, 1, p, q)) continue;
        const float dx = q.x - p.x, dy = q.y - p.y, squared = dx * dx + dy * dy;
        if (!(squared > kShortest * kShortest)) continue;
        if (tested && squared < kShort * kShort && is_behind(screen, *thin.distance, mix(p, q, 0.5f))) continue;
        vertices.push_back({p.x, p.y, p.inv_depth, 0, 0.5f, line.color});
        vertices.push_back({q.x, q.y, q.inv_depth, 0, 0.5f, line.color});
    }
}

}  // namespace clarity::ui
