#include "ui/widgets/frame_graph.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/widgets/formats.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widget_rects.hpp"

namespace clarity::ui {
namespace {

struct Plot {
    ImVec2 low, high;  // corners on the screen
    float top_ms = 1;
    float y(float ms) const { return high.y - (high.y - low.y) * std::min(ms / top_ms, 1.0f); }
};

std::string axis_text(float ms) {
    return number_text(static_cast<double>(ms)) + " ms";
}

void draw_axis(ImDrawList& list, const Plot& plot, float left, float target_ms) {
    const float line = ImGui::GetTextLineHeight();
    for (const float share : {0.0f, 0.5f, 1.0f}) {
        const float ms = plot.top_ms * share, y = std::round(plot.y(ms));
        list.AddLine({plot.low.x, y}, {plot.high.x, y}, ImGui::GetColorU32(ImGuiCol_Separator));
        const std::string text = axis_text(ms);
        list.AddText({left, std::clamp(y - line / 2, plot.low.y - line / 2, plot.high.y - line)},
                     ImGui::GetColorU32(colors::kDim), text.c_str());
    }
    if (target_ms <= 0 || target_ms > plot.top_ms) return;
    const float y = std::round(plot.y(target_ms)), dash = 5 * ui_scale();
    for (float x = plot.low.x; x < plot.high.x; x += 2 * dash)
        list.AddLine({x, y}, {std::min(x + dash, plot.high.x), y}, ImGui::GetColorU32(colors::kGreen));
}

// Draws a series with its newest frame at the right edge.
void draw_series(ImDrawList& list, const Plot& plot, const FrameSeries& series, size_t slots) {
    std::vector<ImVec2> points;
    const float step = (plot.high.x - plot.low.x) / static_cast<float>(std::max<size_t>(slots, 2) - 1);
    for (size_t i = 0; i < series.ms.size(); ++i)
        points.emplace_back(plot.high.x - step * static_cast<float>(series.ms.size() - 1 - i), plot.y(series.ms[i]));
    if (points.size() == 1) points.insert(points.begin(), ImVec2(plot.low.x, points[0].y));
    list.AddPolyline(points.data(), static_cast<int>(points.size()), series.color, 0, 1.5f * ui_scale());
}

}  // namespace

float percentile(std::vector<float> values, double share) {
    if (values.empty()) return 0;
    const double rank = std::ceil(std::clamp(share, 0.0, 1.0) * static_cast<double>(values.size()));
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::max(rank, 1.0)) - 1;
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

float axis_end(float value) {
    if (!(value > 0) || !std::isfinite(value)) return 1;
    const float power = std::pow(10.0f, std::floor(std::log10(value)));
    for (const float step : {1.0f, 2.0f, 5.0f})
        if (value <= step * power * 1.0001f) return step * power;
    return 10 * power;
}

void draw_frame_graph(const std::vector<FrameSeries>& series, float target_ms, float height) {
    const ImVec2 from = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x, line = ImGui::GetTextLineHeight();
    ImGui::InvisibleButton("frame times", {width, height});
    note_rect("frame times");
    // The axis covers 98 % of the times, so that one slow frame does not flatten the rest. It covers all of them if the largest
    // is not much higher.
    float most = 0, largest = 0;
    size_t slots = 60;
    for (const FrameSeries& s : series) {
        most = std::max(most, percentile(s.ms, 0.98));
        for (const float ms : s.ms) largest = std::max(largest, ms);
        slots = std::max(slots, s.ms.size());
    }
    Plot plot;
    plot.top_ms = axis_end(largest < 2 * most ? largest : most * 1.2f);
    const float axis = std::max({ImGui::CalcTextSize(axis_text(plot.top_ms).c_str()).x,
                                 ImGui::CalcTextSize(axis_text(plot.top_ms / 2).c_str()).x}) +
                       8 * ui_scale();
    plot.low = {from.x + axis, from.y + line / 2};
    plot.high = {from.x + width, from.y + height - 2 * ui_scale()};
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(plot.low, plot.high, ImGui::GetColorU32(colors::kGround), 3 * ui_scale());
    draw_axis(list, plot, from.x, target_ms);
    list.PushClipRect(plot.low, plot.high, true);
    for (const FrameSeries& s : series)
        if (!s.ms.empty()) draw_series(list, plot, s, slots);
    list.PopClipRect();
}

}  // namespace clarity::ui
