#include "ui/overlay/ray_lines.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "ui/session/camera_control.hpp"

namespace clarity::ui {
namespace {

constexpr uint32_t kHalo = IM_COL32(0, 0, 0, 150);

constexpr uint32_t kUnder = IM_COL32(0, 0, 0, 150);

glm::vec3 place_of(const rt_path_record& record) {
    return {record.at[0], record.at[1], record.at[2]};
}

// Of the ray that leaves an event: as of Whitted's rays.
uint32_t color_of_event(const rt_path_record& record) {
    const size_t kind = record.kind == RT_PATH_BEGINS || record.how == RT_FIRST_DIFFUSE ? 0
                        : record.how == RT_FIRST_GLOSSY                                 ? 1
                                                                                        : 2;
    return ray_kinds()[kind].color;
}

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

void append_path_lines(const Replay& replay, const std::vector<unsigned>& samples, const Projection& seen, float far,
                       float scale, int selected, LineList& lines) {
    const uint32_t to_light = ray_kinds()[3].color;
    for (size_t i = 0; i < samples.size(); ++i) {
        const bool chosen = static_cast<int>(i) == selected;
        const float width = (chosen ? 4.0f : 1.4f) * scale, opacity = selected < 0 || chosen ? 1.0f : 0.4f;
        const auto draw = [&](const glm::vec3& from, const glm::vec3& to, uint32_t color) {
            lines.line(from, to, kUnder, width + 2 * scale);
            lines.line(from, to, with_opacity(color, opacity), width);
        };
        const auto unit_at = [&](const glm::vec3& place) {
            return seen.unit_at(std::max(seen.to_camera(place).z, seen.near())) * scale;
        };
        const ReplayedSample& sample = replay.samples[samples[i]];
        std::vector<const rt_path_record*> events;  // the camera, and each event
        for (unsigned r = 0; r < sample.records; ++r) {
            const rt_path_record& record = replay.records[sample.first_record + r];
            if (record.kind == RT_PATH_LIT) continue;
            const glm::vec3 at = place_of(record);
            if (!events.empty()) {
                draw(place_of(*events.back()), at, color_of_event(*events.back()));
                lines.dot(at, (chosen ? 6.0f : 3.5f) * unit_at(at), with_opacity(color_of_event(record), opacity), width);
            }
            events.push_back(&record);
        }
        for (unsigned r = 0; r < sample.records; ++r) {
            const rt_path_record& record = replay.records[sample.first_record + r];
            if (record.kind != RT_PATH_LIT || record.bounce >= events.size()) continue;
            const glm::vec3 from = place_of(*events[record.bounce]), at = place_of(record);
            const glm::vec3 to = record.flags & RT_PATH_BEYOND ? from + at * far : at, way = to - from;
            draw(from, to, to_light);
            if (const float length = glm::length(way); length > 0)
                lines.arrow_head(to, way / length, 9 * unit_at(to), with_opacity(to_light, opacity), width);
        }
    }
}

}  // namespace clarity::ui
