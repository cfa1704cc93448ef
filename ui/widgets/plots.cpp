#include "ui/widgets/plots.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ui/widgets/formats.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

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

// From numbers to the screen; the ends are powers of ten.
struct LogAxis {
    double least, most;  // logarithms
    float from, to;      // on the screen

    float at(double value) const {
        return from + (to - from) * static_cast<float>((std::log10(value) - least) / (most - least));
    }
    // Calls mark(value) at each power of ten.
    template <typename Mark>
    void marks(const Mark& mark) const {
        for (double power = least; power <= most + 0.5; ++power) mark(std::pow(10.0, power));
    }
};

LogAxis axis_of(const std::vector<LogSeries>& series, double std::pair<double, double>::* coordinate, float from, float to) {
    double least = INFINITY, most = -INFINITY;
    for (const LogSeries& one : series)
        for (const auto& point : one.points)
            least = std::min(least, std::log10(point.*coordinate)), most = std::max(most, std::log10(point.*coordinate));
    if (!(least <= most)) least = 0, most = 1;
    least = std::floor(least + 1e-9);
    return {least, std::max(std::ceil(most - 1e-9), least + 1), from, to};
}

std::string mark_text(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
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

void draw_log_plot(const char* name, const std::vector<LogSeries>& series, double slope, const char* unit, float height) {
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x, line = ImGui::GetTextLineHeight(), gap = 6 * ui_scale();
    ImGui::InvisibleButton(name, {width, height});
    note_rect(name);
    const float left = corner.x + ImGui::CalcTextSize("0.0001").x + gap, right = corner.x + width - gap;
    const float top = corner.y + line / 2, bottom = corner.y + height - line - gap;
    const LogAxis x = axis_of(series, &std::pair<double, double>::first, left, right),
                  y = axis_of(series, &std::pair<double, double>::second, bottom, top);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled({left, top}, {right, bottom}, ImGui::GetColorU32(colors::kGround), 3 * ui_scale());
    const ImU32 grid = ImGui::GetColorU32(ImGuiCol_Separator), dim = ImGui::GetColorU32(colors::kDim);
    y.marks([&](double value) {
        const float at = std::round(y.at(value));
        list.AddLine({left, at}, {right, at}, grid);
        const std::string text = mark_text(value);
        list.AddText({left - gap - ImGui::CalcTextSize(text.c_str()).x, at - line / 2}, dim, text.c_str());
    });
    const float unit_left = right - ImGui::CalcTextSize(unit).x;
    x.marks([&](double value) {
        const float at = std::round(x.at(value));
        list.AddLine({at, top}, {at, bottom}, grid);
        const std::string text = mark_text(value);
        const float begin = at - ImGui::CalcTextSize(text.c_str()).x / 2, end = at + ImGui::CalcTextSize(text.c_str()).x / 2;
        if (end < unit_left - gap) list.AddText({std::max(begin, corner.x), bottom + gap / 2}, dim, text.c_str());
    });
    list.AddText({unit_left, bottom + gap / 2}, dim, unit);
    list.PushClipRect({left, top}, {right, bottom}, true);
    if (!series.empty() && !series[0].points.empty()) {
        const auto& [x0, y0] = series[0].points.front();
        const double x1 = std::pow(10.0, x.most);
        const ImVec2 a(x.at(x0), y.at(y0)), b(right, y.at(y0 * std::pow(x1 / x0, slope)));
        const int dashes = std::max(1, static_cast<int>((b.x - a.x) / (8 * ui_scale())));
        for (int i = 0; i < dashes; ++i) {
            const float from = static_cast<float>(i) / static_cast<float>(dashes),
                        to = from + 0.5f / static_cast<float>(dashes);
            list.AddLine({a.x + (b.x - a.x) * from, a.y + (b.y - a.y) * from}, {a.x + (b.x - a.x) * to, a.y + (b.y - a.y) * to},
                         ImGui::GetColorU32(colors::kGreen));
        }
    }
    for (const LogSeries& one : series) {
        std::vector<ImVec2> points;
        for (const auto& [px, py] : one.points) points.emplace_back(x.at(px), y.at(py));
        list.AddPolyline(points.data(), static_cast<int>(points.size()), one.color, 0, 1.5f * ui_scale());
        for (const ImVec2& point : points) list.AddCircleFilled(point, 2.5f * ui_scale(), one.color);
    }
    list.PopClipRect();
}

}  // namespace clarity::ui
