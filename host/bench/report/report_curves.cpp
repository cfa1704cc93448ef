// report_curves.cpp -- curves with two logarithmic axes.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bench/report/report_chart.hpp"
#include "bench/report/report_markup.hpp"

namespace clarity::bench {
namespace {

constexpr double kLeft = 56, kTop = 12, kWidth = 420, kHeight = 240, kTotal = 720, kLineHeight = 15;
constexpr size_t kNameBytes = 26;

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f", value);
    return text;
}

// Whole powers of ten which enclose all values.
struct Decades {
    double low = INFINITY, high = -INFINITY;
    void add(double value) {
        low = std::min(low, std::floor(std::log10(value) + 1e-9));
        high = std::max(high, std::ceil(std::log10(value) - 1e-9));
    }
    void close() {
        if (high <= low) high = low + 1;
    }
    double share(double value) const { return (std::log10(value) - low) / (high - low); }
    int step() const { return static_cast<int>(std::ceil((high - low) / 8)); }
};

std::string text_at(double x, double y, const char* anchor, const std::string& text) {
    return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\">" + escape_markup(text) +
           "</text>";
}

// Circle, square, triangle or diamond, so that curves can be told apart without colour.
std::string marker(int shape, double x, double y) {
    const auto at = [&](double dx, double dy) { return number(x + dx) + "," + number(y + dy) + " "; };
    switch (shape % 4) {
        case 0:
            return "<circle cx=\"" + number(x) + "\" cy=\"" + number(y) + "\" r=\"3.5\"/>";
        case 1:
            return "<rect x=\"" + number(x - 3) + "\" y=\"" + number(y - 3) + "\" width=\"6\" height=\"6\"/>";
        case 2:
            return "<polygon points=\"" + at(0, -4) + at(4, 3) + at(-4, 3) + "\"/>";
        default:
            return "<polygon points=\"" + at(0, -4.5) + at(4.5, 0) + at(0, 4.5) + at(-4.5, 0) + "\"/>";
    }
}

// Cuts a name to at most kNameBytes bytes, at whole UTF-8 characters.
std::string shortened(const std::string& name) {
    if (name.size() <= kNameBytes) return name;
    size_t end = kNameBytes - 1;
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xc0u) == 0x80u) --end;
    return name.substr(0, end) + "\u2026";
}

}  // namespace

std::string curve_chart(const CurveChart& chart) {
    Decades x, y;
    bool any = false;
    for (const Curve& curve : chart.curves) {
        any |= curve.points.size() > 1;
        for (const auto& [px, py] : curve.points) {
            x.add(px);
            y.add(py);
        }
    }
    if (!any) return {};
    x.close();
    y.close();
    const auto at_x = [&](double value) { return kLeft + kWidth * x.share(value); };
    const auto at_y = [&](double value) { return kTop + kHeight * (1 - y.share(value)); };

    std::string out = "<figure class=\"curves\"><figcaption>" + escape_markup(chart.title) + " <small>" +
                      escape_markup(chart.y_unit) + "; both axes logarithmic</small></figcaption>\n<div class=\"wide\">";
    const double bottom = kTop + kHeight;
    // Places the curves' names to the right of their last points. Names which overlap are moved down, then all up again if they
    // exceed the bottom.
    std::vector<std::pair<double, const Curve*>> names;
    for (const Curve& curve : chart.curves)
        if (!curve.points.empty()) names.emplace_back(at_y(curve.points.back().second), &curve);
    std::stable_sort(names.begin(), names.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (size_t i = 1; i < names.size(); ++i) names[i].first = std::max(names[i].first, names[i - 1].first + kLineHeight);
    const double total_height = std::max(bottom + 44, kTop + kLineHeight * static_cast<double>(names.size() + 1));
    for (size_t i = names.size(); i-- > 0;)
        names[i].first = std::min(names[i].first, i + 1 < names.size() ? names[i + 1].first - kLineHeight : total_height - 8);

    out += "<svg viewBox=\"0 0 " + number(kTotal) + " " + number(total_height) +
           "\" role=\"img\" xmlns=\"http://www.w3.org/2000/svg\">\n<title>" +
           escape_markup(chart.title + ", " + chart.y_unit + " over " + chart.x_unit) + "</title>\n<g class=\"grid\">";
    for (int d = static_cast<int>(x.low); d <= static_cast<int>(x.high); d += x.step()) {
        const double px = at_x(std::pow(10, d));
        out += "<path d=\"M" + number(px) + " " + number(kTop) + "V" + number(bottom) + "\"/>" +
               text_at(px, bottom + 16, "middle", tick_figure(std::pow(10, d)));
    }
    for (int d = static_cast<int>(y.low); d <= static_cast<int>(y.high); d += y.step()) {
        const double py = at_y(std::pow(10, d));
        out += "<path d=\"M" + number(kLeft) + " " + number(py) + "H" + number(kLeft + kWidth) + "\"/>" +
               text_at(kLeft - 6, py + 4, "end", tick_figure(std::pow(10, d)));
    }
    out += text_at(kLeft + kWidth / 2, bottom + 34, "middle", chart.x_unit) + "</g>\n";

    for (const auto& [name_y, curve] : names) {
        const unsigned color = unsigned(curve->color) % kChartColors;
        std::string path;
        for (const auto& [px, py] : curve->points)
            path += (path.empty() ? "M" : "L") + number(at_x(px)) + " " + number(at_y(py));
        out += "<g class=\"k" + std::to_string(color) + "\"><path class=\"line\" d=\"" + path + "\"/>";
        for (const auto& [px, py] : curve->points)
            out += "<g><title>" + escape_markup(curve->label + ": " + figure(py) + " at " + figure(px)) + "</title>" +
                   marker(curve->color, at_x(px), at_y(py)) + "</g>";
        const double end_x = at_x(curve->points.back().first), end_y = at_y(curve->points.back().second);
        const double name_x = kLeft + kWidth + 18;
        out += "<path class=\"lead\" d=\"M" + number(end_x) + " " + number(end_y) + "L" + number(name_x - 4) + " " +
               number(name_y) + "\"/>" + marker(curve->color, name_x + 2, name_y) + "</g>" +
               text_at(name_x + 10, name_y + 4, "start", shortened(curve->label) + "  " + figure(curve->points.back().second)) +
               "\n";
    }
    return out + "</svg></div></figure>\n";
}

}  // namespace clarity::bench
