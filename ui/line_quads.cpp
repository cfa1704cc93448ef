#include "ui/line_quads.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace clarity {
namespace {

constexpr float kShortest = 0.25f;  // pixels

struct Place {
    float x, y, inv_depth;
};

Place mix(const Place& a, const Place& b, float t) {
    return {a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t, a.inv_depth + (b.inv_depth - a.inv_depth) * t};
}

// Liang and Barsky 1984: the part of a line within 0..width, 0..height, widened by `margin`. False: none.
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

}  // namespace

void append_quads(const LineList& lines, const Projection& projection, float scale, std::vector<LineVertex>& vertices) {
    const Rect& area = projection.area();
    const float width = area.width * scale, height = area.height * scale, near = projection.near();
    const auto place = [&](const glm::vec3& camera) {
        const glm::vec2 p = projection.to_window(camera);
        return Place{(p.x - area.x) * scale, (p.y - area.y) * scale, 1 / camera.z};
    };
    vertices.reserve(vertices.size() + lines.size() * 4);
    for (const Line& line : lines.lines()) {
        glm::vec3 a = projection.to_camera(line.a), b = projection.to_camera(line.b);
        if (!(std::max(a.z, b.z) > near)) continue;
        if (a.z < near) a = b + (a - b) * ((b.z - near) / (b.z - a.z));
        if (b.z < near) b = a + (b - a) * ((a.z - near) / (a.z - b.z));
        a.z = std::max(a.z, near);
        b.z = std::max(b.z, near);
        Place p = place(a), q = place(b);
        const float half = std::max(line.width * scale, 1.0f) / 2, reach = half + 0.5f;
        if (!clip(p, q, width, height, reach)) continue;
        const float dx = q.x - p.x, dy = q.y - p.y, length = std::sqrt(dx * dx + dy * dy);
        if (!(length > kShortest)) continue;
        const float nx = -dy / length * reach, ny = dx / length * reach;
        vertices.push_back({p.x - nx, p.y - ny, p.inv_depth, -reach, half, line.color});
        vertices.push_back({p.x + nx, p.y + ny, p.inv_depth, reach, half, line.color});
        vertices.push_back({q.x - nx, q.y - ny, q.inv_depth, -reach, half, line.color});
        vertices.push_back({q.x + nx, q.y + ny, q.inv_depth, reach, half, line.color});
    }
}

}  // namespace clarity
