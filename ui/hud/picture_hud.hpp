// picture_hud.hpp -- small HUD boxes over a picture: lines of text, colour bars.
#pragma once
#include <imgui.h>

#include <optional>
#include <string>
#include <vector>

#include "render/film/false_colors.hpp"
#include "ui/hud/hud_stack.hpp"
#include "ui/widgets/rect.hpp"

namespace clarity::ui {

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
