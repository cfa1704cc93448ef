#include "ui/widgets/log_plot.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ui/widgets/theme.hpp"
#include "ui/widgets/widget_rects.hpp"

namespace clarity::ui {
namespace {

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

LogAxis axis_of(const std::vector<LogSeries>& series, double std::pair<double, double>::*coordinate, float from, float to) {
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
