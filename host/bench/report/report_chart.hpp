// report_chart.hpp -- bar charts and curves of a report. Bars are CSS boxes, so that their text keeps its size on any screen;
// curves are SVG. Every bar shows its number. The colours are those of Okabe and Ito (2008, Color Universal Design), which
// colour-blind people can tell apart, and no chart needs colours to be read.
#pragma once
#include <string>
#include <vector>

namespace clarity::bench {

inline constexpr int kChartColors = 7;

struct Bar {
    std::string label;
    double value = 0;
    int color = 0;     // any number; taken modulo kChartColors
    std::string hint;  // shown when the pointer is over the bar
    std::string text;  // shown instead of the number; a bar of value 0 is this text only
};

struct BarGroup {
    std::string title;  // may be empty
    std::vector<Bar> bars;
};

struct BarChart {
    std::string title, unit;
    std::vector<BarGroup> groups;
    double reference = 0;  // value of a line across the chart; 0: none
    std::string reference_text;
    double whole = 0;  // the axis reaches at least to this: 100 for percents
};

// The chart as markup; empty if it has no bars. The axis is logarithmic if the largest value is more than 30 times the
// smallest.
std::string bar_chart(const BarChart& chart);

struct Curve {
    std::string label;
    int color = 0;
    std::vector<std::pair<double, double>> points;  // all positive
};

struct CurveChart {
    std::string title, x_unit, y_unit;
    std::vector<Curve> curves;
};

// The chart as SVG with logarithmic axes; empty if no curve has two points.
std::string curve_chart(const CurveChart& chart);

}  // namespace clarity::bench
