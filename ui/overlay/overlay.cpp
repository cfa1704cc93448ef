#include "ui/overlay/overlay.hpp"

#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "base/log.hpp"

namespace clarity::ui {
namespace {

bool same(const ShownStructure& a, const ShownStructure& b) {
    return a.accel == b.accel && a.is_moved == b.is_moved && !a.moved.owner_before(b.moved) && !b.moved.owner_before(a.moved);
}

}  // namespace

std::string level_name(rt_u32 level) {
    return level == RT_LEVEL_BOTTOM ? "bottom level" : "level " + std::to_string(level + 1);
}

// Hues of neighbouring levels differ by the golden ratio of a full turn, so that levels close to each other look different.
uint32_t level_color(rt_u32 level) {
    if (level == RT_LEVEL_BOTTOM) return IM_COL32(244, 180, 80, 255);
    const float hue = std::fmod(0.11f + 0.618034f * static_cast<float>(level % 64), 1.0f);
    return static_cast<uint32_t>(static_cast<ImU32>(ImColor::HSV(hue, 0.62f, 1.0f)));
}

void VolumeOverlay::toggle(rt_u32 level) {
    if (level_ == level)
        level_.reset();
    else
        level_ = level;
}

size_t VolumeOverlay::count(unsigned side) const {
    const Result& volumes = sides_[side].volumes;
    return volumes ? volumes->boxes.size() + volumes->spheres.size() : 0;
}

void VolumeOverlay::update(const ShownStructure& main, const ShownStructure& other) {
    update_side(sides_[0], main);
    update_side(sides_[1], other);
}

void VolumeOverlay::update_side(Side& side, const ShownStructure& structure) {
    if (side.fetching.valid()) {
        if (side.fetching.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
        try {
            side.volumes = side.fetching.get();
        } catch (const std::exception& error) {
            log(LogLevel::warning, std::string("bounding volumes: ") + error.what());
            side.volumes.reset();
        }
        ++side.revision;
    }
    if (!structure.accel || !level_) {
        if (side.volumes) ++side.revision;
        side.volumes.reset();
        side.structure = {};
        side.fetched.reset();
        return;
    }
    if (same(side.structure, structure) && side.fetched == level_) return;
    side.structure = structure;
    side.fetched = level_;
    side.fetching = std::async(std::launch::async, [structure, level = *level_, wake = wake_] {
        auto found = std::make_shared<Level>();
        // Ask for one volume more than is drawn, to know whether there are more.
        if (!structure.is_moved)
            static_cast<Volumes&>(*found) = accel_volumes(*structure.accel, level, kLimit + 1);
        else if (const auto moved = structure.moved.lock())  // else a newer pose follows
            static_cast<Volumes&>(*found) = accel_volumes(*structure.accel, level, kLimit + 1, moved.get());
        found->more = found->boxes.size() + found->spheres.size() > kLimit;
        if (found->more && found->spheres.empty())
            found->boxes.pop_back();
        else if (found->more)
            found->spheres.pop_back();
        wake();
        return Result(std::move(found));
    });
}

void VolumeOverlay::append_lines(unsigned index, const glm::vec3& eye, float scale, unsigned stride, LineList& lines) const {
    const Side& side = sides_[index];
    if (!side.volumes || !side.fetched) return;
    // The more volumes there are, the fainter and simpler they are drawn.
    const size_t shown = std::max<size_t>(count(index), 1);
    const float strength = std::clamp(8.0f / std::sqrt(static_cast<float>(shown)), 0.3f, 1.0f);
    const float width = (shown < 64 ? 1.8f : shown < 1000 ? 1.4f : 1.0f) * scale;
    const uint32_t color = with_opacity(level_color(*side.fetched), strength), faint = with_opacity(color, 0.4f);
    const int segments = std::clamp(static_cast<int>(16000 / shown), 12, 64);
    const bool circles = shown <= 200;  // with more, the outlines show as much
    const auto& boxes = side.volumes->boxes;
    const auto& spheres = side.volumes->spheres;
    lines.reserve(lines.size() +
                  (boxes.size() * 12 + spheres.size() * static_cast<size_t>(segments) * (circles ? 4 : 1)) / stride);
    for (size_t i = 0; i < boxes.size(); i += stride) lines.box(boxes[i], color, width);
    for (size_t i = 0; i < spheres.size(); i += stride) {
        const glm::vec3 center(spheres[i][0], spheres[i][1], spheres[i][2]);
        if (circles) lines.great_circles(center, spheres[i][3], segments, faint, width);
        lines.outline(center, spheres[i][3], eye, segments, color, width);
    }
}

}  // namespace clarity::ui
