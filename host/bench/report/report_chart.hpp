// report_chart.hpp -- bars and curves of a report. Bars are boxes of CSS, so that their text keeps its size on any screen;
// curves are SVG. Every bar has its number behind it; colours are those of Okabe and Ito (2008, Color Universal Design), which
// people who see fewer colours tell apart, and no chart needs colour to be read.
#pragma once
#include <string>
#include <vector>

namespace clarity::bench {

inline constexpr int kChartColors = 7;

struct Bar {
    std::string label;
    double value = 0;
    int color = 0;     // any number: taken modulo kChartColors
    std::string hint;  // shown when pointed at
    std::string text;  // behind the bar instead of the number; a bar without value is then only text
};

struct BarGroup {
    std::string title;  // may be empty
    std::vector<Bar> bars;
};

struct BarChart {
    std::string title, unit;
    std::vector<BarGroup> groups;
    double reference = 0;  // a line across; 0: none
    std::string reference_text;
    double whole = 0;  // the axis reaches at least this: 100 for percents
};

// Logarithmic from a factor of 30 on between what is shown. Empty without bars.
std::string bar_chart(const BarChart& chart);

struct Curve {
    std::string label;
    int color = 0;
    std::vector<std::pair<double, double>> points;  // positive
};

struct CurveChart {
    std::string title, x_unit, y_unit;
    std::vector<Curve> curves;
};

// Both axes logarithmic. Empty without a curve of two points.
std::string curve_chart(const CurveChart& chart);

}  // namespace clarity::bench
