#include "ui/overlay/ray_lines.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "ui/session/camera_control.hpp"

namespace clarity::ui {
namespace {

constexpr uint32_t kHalo = IM_COL32(0, 0, 0, 150);

}  // namespace

const std::vector<RayKind>& ray_kinds() {
    static const std::vector<RayKind> kinds = {{"camera", IM_COL32(240, 240, 240, 255)},
                                               {"mirror", IM_COL32(80, 200, 255, 255)},
                                               {"refracted", IM_COL32(236, 120, 255, 255)},
                                               {"to a light", IM_COL32(255, 220, 80, 255)},
                                               {"in shadow", IM_COL32(235, 90, 80, 255)}};
    return kinds;
}

size_t ray_kind_of(const RayRecord& ray) {
    switch (ray.kind) {
        case RayRecord::Kind::camera:
            return 0;
        case RayRecord::Kind::mirror:
            return 1;
        case RayRecord::Kind::refracted:
            return 2;
        case RayRecord::Kind::shadow:
            break;
    }
    return ray.occluded ? 4 : 3;
}

void append_ray_lines(const RayTree& tree, const Projection& seen, float far, float scale, int selected, LineList& lines) {
    for (size_t i = 0; i < tree.rays.size(); ++i) {
        const RayRecord& ray = tree.rays[i];
        const bool followed = ray.fate == RayRecord::Fate::traced, chosen = static_cast<int>(i) == selected;
        if (!followed && !chosen && ray.fate != RayRecord::Fate::dropped) continue;
        const glm::vec3 from = vec(ray.origin), along = vec(ray.direction);
        const bool ends = followed && std::isfinite(ray.t);
        const glm::vec3 to = from + along * (ends ? ray.t : followed ? far : far * 0.05f);
        const uint32_t color = with_opacity(ray_kinds()[ray_kind_of(ray)].color, followed ? 1.0f : 0.5f);
        const float width = (chosen ? 4.0f : 1.8f) * scale;
        lines.line(from, to, kHalo, width + 2 * scale);
        lines.line(from, to, color, width);
        const float depth = std::max(seen.to_camera(to).z, seen.near());
        const float unit = seen.unit_at(depth) * scale;
        if (ends && ray.kind != RayRecord::Kind::shadow)
            lines.dot(to, (chosen ? 6.0f : 4.0f) * unit, color, width);
        else
            lines.arrow_head(to, along, 9 * unit, color, width);
    }
}

}  // namespace clarity::ui
