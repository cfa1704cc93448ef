#include "ui/widgets/slider_bar.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/widgets/theme.hpp"

namespace clarity::ui {

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

}  // namespace clarity::ui
