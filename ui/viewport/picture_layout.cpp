#include "ui/viewport/picture_layout.hpp"

#include <algorithm>
#include <cmath>

namespace clarity::ui {
namespace {

// Rounds the size to whole units, so that overlays match the picture's pixels.
Rect whole(const Rect& area) {
    return {area.x, area.y, std::max(1.0f, std::floor(area.width)), std::max(1.0f, std::floor(area.height))};
}

}  // namespace

std::vector<PicturePlace> lay_out_pictures(const Rect& room, float aspect, bool compared, CompareMode mode, float wipe,
                                           float head, float foot) {
    using What = PicturePlace::What;
    if (!compared || mode != CompareMode::side_by_side) {
        const Rect area = whole(letter_box(room, aspect));
        if (!compared) return {{What::main, area, area}};
        if (mode == CompareMode::difference) return {{What::difference, area, area}};
        const float at = std::round(area.width * std::clamp(wipe, 0.0f, 1.0f));
        return {{What::main, area, {area.x, area.y, at, area.height}},
                {What::other, area, {area.x + at, area.y, area.width - at, area.height}}};
    }
    const float gap = std::min(std::round(room.width * 0.02f), 12.0f), half = std::floor((room.width - gap) / 2);
    const float taken = std::min(head, room.height / 2);
    Rect left = whole(letter_box({room.x, room.y + taken, half, room.height - taken}, aspect));
    const float free = room.height - taken - left.height;
    left.y = room.y + taken + std::floor(std::max(0.0f, free - std::max(foot, 0.0f)) / 2);
    Rect right = left;
    right.x += half + gap;
    return {{What::main, left, left}, {What::other, right, right}};
}

bool pixel_at(const Rect& area, const glm::vec2& place, unsigned width, unsigned height, unsigned& x, unsigned& y) {
    if (!area.holds(place.x, place.y) || width == 0 || height == 0) return false;
    x = std::min(width - 1, static_cast<unsigned>((place.x - area.x) / area.width * static_cast<float>(width)));
    y = std::min(height - 1, static_cast<unsigned>((place.y - area.y) / area.height * static_cast<float>(height)));
    return true;
}

}  // namespace clarity::ui
