// picture_cards.hpp -- small cards of text in the corners of a picture, stacked so that none covers another.
#pragma once
#include <imgui.h>

#include <optional>
#include <string>
#include <vector>

#include "render/false_colors.hpp"
#include "ui/viewport.hpp"

namespace clarity {

enum class Corner { top_left, top_right, bottom_left, bottom_right };

// Hands out the room of one picture's corners: columns at its left and right, filled from above and from below. Where two columns
// would be narrower than `least`, there is one.
class CardStack {
 public:
    CardStack() = default;
    CardStack(const Rect& area, float margin, float least = 0);
    // Of a card at most.
    float max_width() const { return max_width_; }
    // nullopt: no room is left there.
    std::optional<Rect> take(Corner corner, const ImVec2& size);

 private:
    Rect area_;
    float margin_ = 0, max_width_ = 0;
    bool one_column_ = false;
    float above_[2] = {}, below_[2] = {};  // taken so far, of the left and the right column
};

struct CardText {
    std::string text;
    ImVec4 color;
    bool bold = false;
    bool same_line = false;  // after the one before, where there is room
};

// The size of lines in a card no wider than that, wrapped where they are longer.
ImVec2 card_size(const std::vector<CardText>& lines, float max_width);
void draw_card(ImDrawList& list, const Rect& card, const std::vector<CardText>& lines);
// The card's ground alone.
void draw_card_ground(ImDrawList& list, const Rect& card);
float card_padding();

// A bar of colours with numbers, unit and, if known, a mark at a value.
ImVec2 color_bar_size(const FalseColorScale& scale, float max_width);
void draw_color_bar(ImDrawList& list, const Rect& card, const FalseColorScale& scale, std::optional<float> value);
// As the bar writes it: "12", "0.42", "1.2 k".
std::string scale_number(const FalseColorScale& scale, float value);

}  // namespace clarity
