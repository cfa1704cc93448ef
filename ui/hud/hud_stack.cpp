#include "ui/hud/hud_stack.hpp"

#include <algorithm>
#include <cmath>

namespace clarity::ui {

HudStack::HudStack(const Rect& area, float margin, float least) : area_(area), margin_(margin) {
    const float half = std::floor((area.width - 3 * margin) / 2);
    one_column_ = half < least;
    max_width_ = std::max(0.0f, one_column_ ? area.width - 2 * margin : half);
}

std::optional<Rect> HudStack::take(Corner corner, float width, float height) {
    const bool right = corner == Corner::top_right || corner == Corner::bottom_right;
    const bool low = corner == Corner::bottom_left || corner == Corner::bottom_right;
    const int column = right && !one_column_;
    float& taken = low ? below_[column] : above_[column];
    if (width > max_width_ + 0.5f || above_[column] + below_[column] + height + 2 * margin_ > area_.height) return std::nullopt;
    const float x = right ? area_.x + area_.width - margin_ - width : area_.x + margin_;
    const float y = low ? area_.y + area_.height - margin_ - taken - height : area_.y + margin_ + taken;
    taken += height + std::round(margin_ * 0.75f);
    return Rect{std::floor(x), std::floor(y), width, height};
}

}  // namespace clarity::ui
