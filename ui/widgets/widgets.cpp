#include "ui/widgets/widgets.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/error.hpp"
#include "ui/session/session.hpp"
#include "ui/widgets/theme.hpp"

namespace clarity::ui {
namespace {

constexpr float kLabelWidth = 130;

bool inside_character(const std::string& text, size_t at) {  // of UTF-8
    return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80;
}

float text_width(const std::string& text) {
    return ImGui::CalcTextSize(text.c_str()).x;
}

void title_text(const char* title) {
    ImGui::PushFont(fonts().bold);
    ImGui::PushStyleColor(ImGuiCol_Text, colors::kDim);
    ImGui::TextUnformatted(title);
    ImGui::PopStyleColor();
    ImGui::PopFont();
}

struct Place {
    Rect rect;
    int frame = -1;
    bool inside = false;  // not scrolled out of sight
};
std::unordered_map<std::string, Place>& widget_rects() {
    static std::unordered_map<std::string, Place> all;
    return all;
}
std::string wanted;  // label of the rectangle that is to be scrolled into view

}  // namespace

std::string cut_to(const std::string& text, float width) {
    if (text_width(text) <= width) return text;
    size_t low = 0, high = text.size();  // the first `low` bytes fit
    while (low + 1 < high) {
        const size_t middle = (low + high) / 2;
        (text_width(text.substr(0, middle) + "\u2026") <= width ? low : high) = middle;
    }
    while (low > 0 && inside_character(text, low)) --low;
    return text.substr(0, low) + "\u2026";
}

std::string cut_front_to(const std::string& text, float width) {
    if (text_width(text) <= width) return text;
    size_t low = 0, high = text.size();  // the bytes from `high` on fit
    while (low + 1 < high) {
        const size_t middle = (low + high) / 2;
        (text_width("\u2026" + text.substr(middle)) <= width ? high : low) = middle;
    }
    while (inside_character(text, high)) ++high;
    return "\u2026" + text.substr(high);
}

void section(const char* title) {
    ImGui::Dummy({0, 6 * ui_scale()});
    title_text(title);
    ImGui::Separator();
}

bool folding_section(const char* title, bool open) {
    ImGui::Dummy({0, 6 * ui_scale()});
    ImGuiStorage& storage = *ImGui::GetStateStorage();
    const ImGuiID id = ImGui::GetID(title);
    bool unfolded = storage.GetBool(id, open);
    const ImVec2 from = ImGui::GetCursorScreenPos();
    const ImVec2 size(ImGui::GetContentRegionAvail().x, ImGui::GetTextLineHeight());
    if (ImGui::InvisibleButton(title, size)) storage.SetBool(id, unfolded = !unfolded);
    note_rect(title);
    const bool hovered = ImGui::IsItemHovered();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImU32 color = ImGui::GetColorU32(hovered ? colors::kText : colors::kDim);
    list.AddText(fonts().bold, fonts().bold->FontSize, from, color, title);
    const char* sign = unfolded ? "\u25be" : "\u25b8";
    list.AddText({from.x + size.x - ImGui::CalcTextSize(sign).x, from.y}, color, sign);
    ImGui::Separator();
    return unfolded;
}

void tooltip(const std::string& text) {
    if (text.empty() || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(10 * ui_scale(), 8 * ui_scale()));
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(320 * ui_scale());
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
    ImGui::PopStyleVar();
}

bool option(const std::string& label, bool chosen) {
    const bool clicked = ImGui::Selectable(label.c_str(), chosen);
    note_rect(label);
    return clicked && !chosen;
}

bool slider(const char* id, float& value, float min, float max, const char* format, bool logarithmic) {
    const ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp | (logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
    draw_slider_bar(value, min, max, logarithmic);
    const BareFrames bare;
    return ImGui::SliderFloat(id, &value, min, max, format, flags);
}

bool color_field(const char* id, float* rgb) {
    return ImGui::ColorEdit3(id, rgb, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR);
}

void row_label(const char* label, const std::string& help) {
    const float start = ImGui::GetCursorPosX(), width = kLabelWidth * ui_scale();
    ImGui::AlignTextToFramePadding();
    const std::string text = cut_to(label, width - 8 * ui_scale());
    ImGui::TextUnformatted(text.c_str());
    tooltip(text == label ? help : std::string(label) + "\n" + help);
    ImGui::SameLine(start + width);
    const ImVec2 from = ImGui::GetCursorScreenPos();
    note_rect(label, {from.x, from.y, ImGui::GetContentRegionAvail().x, ImGui::GetFrameHeight()});
    ImGui::SetNextItemWidth(-FLT_MIN);
}

void row_text(const char* label, const std::string& value, const std::string& help, const ImVec4& color) {
    const float start = ImGui::GetCursorPosX(), width = kLabelWidth * ui_scale();
    const std::string text = cut_to(label, width - 8 * ui_scale());
    ImGui::PushStyleColor(ImGuiCol_Text, colors::kDim);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopStyleColor();
    tooltip(text == label ? help : std::string(label) + "\n" + help);
    ImGui::SameLine(start + width);
    wrapped_text(value, color);
}

void wrapped_text(const std::string& text, const ImVec4& color) {
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
}

void dim_text(const std::string& text) {
    wrapped_text(text, colors::kDim);
}

bool button(const char* label, const std::string& help, float width) {
    const bool pressed = ImGui::Button(label, {width, 0});
    const std::string name = label;
    note_rect(name.substr(0, name.find("##")));
    tooltip(help);
    return pressed;
}

bool toggle_button(const char* label, bool on, const std::string& help, float width) {
    if (on) {
        const ImVec4& accent = colors::kAccent;
        ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(accent.x, accent.y, accent.z, 0.38f));
    }
    const bool pressed = button(label, help, width);
    if (on) ImGui::PopStyleColor();
    return pressed;
}

float share_of_line(int count) {
    const float gaps = ImGui::GetStyle().ItemSpacing.x * static_cast<float>(count - 1);
    return (ImGui::GetContentRegionAvail().x - gaps) / static_cast<float>(count);
}

void same_line_if_fits(const char* next_label) {
    const ImGuiStyle& style = ImGui::GetStyle();
    const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
    const float needed = style.ItemSpacing.x + ImGui::CalcTextSize(next_label, nullptr, true).x + 2 * style.FramePadding.x;
    if (ImGui::GetItemRectMax().x + needed <= right) ImGui::SameLine();
}

void attempt(Session& session, const std::function<void()>& what) {
    try {
        what();
    } catch (const Error& error) {
        session.messages().report(error.what(), error.details());
    }
}

void draw_slider_bar(double value, double min, double max, bool logarithmic) {
    double share = max > min ? (value - min) / (max - min) : 0;
    if (logarithmic) {  // like ImGui: zero counts as the smallest number shown
        const double least = min > 0 ? min : 1e-3;
        share = std::log(std::max(value, least) / least) / std::log(max / least);
    }
    const ImVec2 from = ImGui::GetCursorScreenPos();
    const ImVec2 to(from.x + ImGui::CalcItemWidth(), from.y + ImGui::GetFrameHeight());
    const auto end = from.x + (to.x - from.x) * static_cast<float>(std::clamp(share, 0.0, 1.0));
    const bool hovered = ImGui::IsMouseHoveringRect(from, to) && ImGui::IsWindowHovered();
    const float rounding = ImGui::GetStyle().FrameRounding;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(from, to, ImGui::GetColorU32(hovered ? ImGuiCol_FrameBgHovered : ImGuiCol_FrameBg), rounding);
    const ImVec4& accent = colors::kAccent;
    if (end > from.x + 1)
        list.AddRectFilled(from, {end, to.y}, ImGui::GetColorU32(ImVec4(accent.x, accent.y, accent.z, hovered ? 0.5f : 0.4f)),
                           rounding, end < to.x - 1 ? ImDrawFlags_RoundCornersLeft : ImDrawFlags_RoundCornersAll);
}

BareFrames::BareFrames() {
    for (const ImGuiCol color : {ImGuiCol_FrameBg, ImGuiCol_FrameBgHovered, ImGuiCol_FrameBgActive})
        ImGui::PushStyleColor(color, ImVec4(0, 0, 0, 0));
}

BareFrames::~BareFrames() {
    ImGui::PopStyleColor(3);
}

void note_rect(const std::string& label, const Rect& rect) {
    if (label.empty()) return;
    const ImVec2 low = ImGui::GetWindowDrawList()->GetClipRectMin(), high = ImGui::GetWindowDrawList()->GetClipRectMax();
    const float middle = rect.y + rect.height / 2;
    const bool inside = middle > low.y && middle < high.y && rect.x < high.x && rect.x + rect.width > low.x;
    Place& place = widget_rects()[label];
    // If two rectangles of one frame have the same label, the visible one is kept.
    if (inside || !place.inside || place.frame != ImGui::GetFrameCount()) place = {rect, ImGui::GetFrameCount(), inside};
    if (wanted != label) return;
    wanted.clear();
    if (!inside) ImGui::SetScrollHereY(0.5f);
}

void note_rect(const std::string& label) {
    const ImVec2 from = ImGui::GetItemRectMin(), to = ImGui::GetItemRectMax();
    note_rect(label, {from.x, from.y, to.x - from.x, to.y - from.y});
}

const Rect* drawn_rect(const std::string& label) {
    const auto found = widget_rects().find(label);
    // A script asks between two frames, before ImGui counts the next one.
    if (found == widget_rects().end() || found->second.frame < ImGui::GetFrameCount() - 1) return nullptr;
    if (found->second.inside) return &found->second.rect;
    wanted = label;
    return nullptr;
}

}  // namespace clarity::ui
