// hud_stack.hpp -- places HUD boxes in the corners of a picture so that none covers another. Pure arithmetic.
#pragma once
#include <optional>

#include "ui/widgets/rect.hpp"

namespace clarity::ui {

enum class Corner { top_left, top_right, bottom_left, bottom_right };

// The free room in one picture's corners: a column at the left and one at the right, each filled from above and from below. If
// two columns would be narrower than `least`, there is only one.
class HudStack {
 public:
    HudStack() = default;
    HudStack(const Rect& area, float margin, float least = 0);
    // The largest width of a box.
    float max_width() const { return max_width_; }
    // Takes room for a box. Returns nullopt if there is not enough left in this corner.
    std::optional<Rect> take(Corner corner, float width, float height);

 private:
    Rect area_;
    float margin_ = 0, max_width_ = 0;
    bool one_column_ = false;
    float above_[2] = {}, below_[2] = {};  // heights taken so far in the left and the right column
};

}  // namespace clarity::ui
