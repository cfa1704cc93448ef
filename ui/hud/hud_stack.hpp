// hud_stack.hpp -- room for cards in the corners of a picture, so that none covers another. Pure arithmetic.
#pragma once
#include <optional>

#include "ui/viewport/viewport.hpp"

namespace clarity::ui {

enum class Corner { top_left, top_right, bottom_left, bottom_right };

// Hands out the room of one picture's corners: columns at its left and right, filled from above and from below. Where two
// columns would be narrower than `least`, there is one.
class HudStack {
 public:
    HudStack() = default;
    HudStack(const Rect& area, float margin, float least = 0);
    // Of a card at most.
    float max_width() const { return max_width_; }
    // nullopt: no room is left there.
    std::optional<Rect> take(Corner corner, float width, float height);

 private:
    Rect area_;
    float margin_ = 0, max_width_ = 0;
    bool one_column_ = false;
    float above_[2] = {}, below_[2] = {};  // taken so far, of the left and the right column
};

}  // namespace clarity::ui
