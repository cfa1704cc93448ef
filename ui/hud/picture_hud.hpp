// picture_hud.hpp -- small HUD boxes over a picture: lines of text, colour bars; and where they stand.
#pragma once
#include <imgui.h>

#include <optional>
#include <string>
#include <vector>

#include "picture/false_colors.hpp"
#include "ui/widgets/rect.hpp"

namespace clarity::ui {

// Places HUD boxes in the corners of a picture so that none covers another. Pure arithmetic.
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

struct HudText {
    std::string text;
    ImVec4 color;
    bool bold = false;
    bool same_line = false;  // on the line of the text before it, if there is room
};

// The size of a box with these lines. Lines which are longer than max_width are wrapped.
ImVec2 card_size(const std::vector<HudText>& lines, float max_width);
void draw_hud_box(ImDrawList& list, const Rect& box, const std::vector<HudText>& lines);
// Draws only the background of a box.
void draw_hud_ground(ImDrawList& list, const Rect& box);
float hud_padding();

// A colour bar with numbers and unit, and a mark at `value` if there is one.
ImVec2 color_bar_size(const FalseColorScale& scale, float max_width);
void draw_color_bar(ImDrawList& list, const Rect& box, const FalseColorScale& scale, std::optional<float> value);
// A number as the bar shows it: "12", "0.42", "1.2 k".
std::string scale_number(const FalseColorScale& scale, float value);

}  // namespace clarity::ui
