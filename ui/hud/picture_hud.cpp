#include "ui/hud/picture_hud.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

constexpr int kBarSteps = 64;

ImU32 ground_color() {
    return ImGui::GetColorU32(ImVec4(0.04f, 0.045f, 0.055f, 0.78f));
}

struct Piece {
    ImVec2 at, size;
};

// Lays out the lines from the box's inner corner. Returns the pieces; `total` receives the size of all.
std::vector<Piece> flow(const std::vector<HudText>& lines, float room, ImVec2& total) {
    std::vector<Piece> pieces;
    const float gap = std::round(8 * ui_scale()), leading = std::round(3 * ui_scale());
    float x = 0, y = 0, line_height = 0;
    total = {0, 0};
    for (const HudText& line : lines) {
        ImFont* font = line.bold ? fonts().bold : fonts().text;
        const ImVec2 whole = font->CalcTextSizeA(font->FontSize, FLT_MAX, 0, line.text.c_str());
        const bool beside = line.same_line && !pieces.empty() && x + gap + whole.x <= room;
        if (!beside && !pieces.empty()) {
            y += line_height + leading;
            x = line_height = 0;
        }
        const float at = beside ? x + gap : 0;
        const ImVec2 size =
            whole.x <= room ? whole : font->CalcTextSizeA(font->FontSize, FLT_MAX, std::max(room, 1.0f), line.text.c_str());
        pieces.push_back({{at, y}, size});
        x = at + size.x;
        line_height = std::max(line_height, size.y);
        total.x = std::max(total.x, std::min(x, room));
        total.y = y + line_height;
    }
    return pieces;
}

}  // namespace

float hud_padding() {
    return std::round(7 * ui_scale());
}

ImVec2 card_size(const std::vector<HudText>& lines, float max_width) {
    ImVec2 total;
    flow(lines, max_width - 2 * hud_padding(), total);
    return {std::ceil(total.x + 2 * hud_padding()), std::ceil(total.y + 2 * hud_padding())};
}

void draw_hud_ground(ImDrawList& list, const Rect& box) {
    list.AddRectFilled({box.x, box.y}, {box.x + box.width, box.y + box.height}, ground_color(), 5 * ui_scale());
}

void draw_hud_box(ImDrawList& list, const Rect& box, const std::vector<HudText>& lines) {
    draw_hud_ground(list, box);
    ImVec2 total;
    const float room = box.width - 2 * hud_padding() + 0.5f;
    const std::vector<Piece> pieces = flow(lines, room, total);
    for (size_t i = 0; i < lines.size(); ++i) {
        ImFont* font = lines[i].bold ? fonts().bold : fonts().text;
        const ImVec2 at(box.x + hud_padding() + pieces[i].at.x, box.y + hud_padding() + pieces[i].at.y);
        list.AddText(font, font->FontSize, at, ImGui::GetColorU32(lines[i].color), lines[i].text.c_str(), nullptr,
                     std::max(room, 1.0f));
    }
}

std::string scale_number(const FalseColorScale& scale, float value) {
    if (scale.whole) return count_text(std::round(value));
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
}

ImVec2 color_bar_size(const FalseColorScale& scale, float max_width) {
    const std::string title = scale.label + (scale.unit.empty() ? "" : ", " + scale.unit);
    const float line = fonts().text->FontSize, inner = max_width - 2 * hud_padding();
    const float text = fonts().text->CalcTextSizeA(line, FLT_MAX, 0, title.c_str()).x;
    const float width = std::min(inner, std::max(text, 190 * ui_scale()));
    const float title_height = fonts().text->CalcTextSizeA(line, FLT_MAX, std::max(width, 1.0f), title.c_str()).y;
    return {std::ceil(width + 2 * hud_padding()),
            std::ceil(2 * hud_padding() + title_height + 10 * ui_scale() + line + 9 * ui_scale())};
}

void draw_color_bar(ImDrawList& list, const Rect& box, const FalseColorScale& scale, std::optional<float> value) {
    const float unit = ui_scale(), pad = hud_padding(), left = box.x + pad, width = box.width - 2 * pad;
    ImFont* font = fonts().text;
    const auto text_width = [&](const std::string& text) {
        return font->CalcTextSizeA(font->FontSize, FLT_MAX, 0, text.c_str()).x;
    };
    const auto write = [&](float x, float y, const ImVec4& color, const std::string& text) {
        list.AddText(font, font->FontSize, {std::floor(x), std::floor(y)}, ImGui::GetColorU32(color), text.c_str(), nullptr,
                     width + 0.5f);
    };
    draw_hud_ground(list, box);
    write(left, box.y + pad, colors::kText, scale.label + (scale.unit.empty() ? "" : ", " + scale.unit));
    const float numbers = box.y + box.height - pad - font->FontSize, bottom = numbers - 4 * unit, top = bottom - 10 * unit;
    for (int i = 0; i < kBarSteps; ++i) {
        const float from = static_cast<float>(i) / kBarSteps, to = static_cast<float>(i + 1) / kBarSteps;
        const auto rgb = color_at(scale, (from + to) / 2);
        list.AddRectFilled({left + width * from, top}, {left + width * to, bottom}, IM_COL32(rgb[0], rgb[1], rgb[2], 255));
    }
    const float span = scale.max - scale.min;
    const std::string least = scale_number(scale, scale.min), most = scale_number(scale, scale.max);
    float taken_left = left + text_width(least) + 6 * unit;
    const float taken_right = left + width - text_width(most) - 6 * unit;
    write(left, numbers, colors::kDim, least);
    write(left + width - text_width(most), numbers, colors::kDim, most);
    const auto mark = [&](float at, const ImVec4& color, const std::string& text) {
        const float w = text_width(text), x = std::clamp(at - w / 2, taken_left, std::max(taken_left, taken_right - w));
        if (x + w <= taken_right) write(x, numbers, color, text);
    };
    if (value && std::isfinite(*value)) {
        const float at = left + width * (span > 0 ? std::clamp((*value - scale.min) / span, 0.0f, 1.0f) : 0);
        list.AddTriangleFilled({at, top + 3 * unit}, {at - 4 * unit, top - 4 * unit}, {at + 4 * unit, top - 4 * unit},
                               ImGui::GetColorU32(colors::kText));
        list.AddLine({at, top}, {at, bottom}, IM_COL32(0, 0, 0, 255));
        mark(at, colors::kText, scale_number(scale, *value));
    } else if (!scale.whole || span >= 2) {
        const float middle = scale.whole ? std::round(scale.min + span / 2) : scale.min + span / 2;
        mark(left + width / 2, colors::kDim, scale_number(scale, middle));
    }
}

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
