// picture_hud.hpp -- small cards over a picture: lines of text, bars of colours.
#pragma once
#include <imgui.h>

#include <optional>
#include <string>
#include <vector>

#include "render/film/false_colors.hpp"
#include "ui/hud/hud_stack.hpp"
#include "ui/viewport/viewport.hpp"

namespace clarity::ui {

struct HudText {
    std::string text;
    ImVec4 color;
    bool bold = false;
    bool same_line = false;  // after the one before, where there is room
};

// The size of lines in a card no wider than that, wrapped where they are longer.
ImVec2 card_size(const std::vector<HudText>& lines, float max_width);
void draw_hud_card(ImDrawList& list, const Rect& card, const std::vector<HudText>& lines);
// The card's ground alone.
void draw_card_ground(ImDrawList& list, const Rect& card);
float card_padding();

// A bar of colours with numbers, unit and, if known, a mark at a value.
ImVec2 color_bar_size(const FalseColorScale& scale, float max_width);
void draw_color_bar(ImDrawList& list, const Rect& card, const FalseColorScale& scale, std::optional<float> value);
// As the bar writes it: "12", "0.42", "1.2 k".
std::string scale_number(const FalseColorScale& scale, float value);

}  // namespace clarity::ui
