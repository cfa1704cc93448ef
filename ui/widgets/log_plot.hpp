// log_plot.hpp -- a graph with logarithmic axes.
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace clarity::ui {

struct LogSeries {
    std::vector<std::pair<double, double>> points;  // x and y, both above 0
    unsigned color = 0;                             // packed as ImGui does
};
// A dashed line goes through the first point of the first series with this slope. name: for note_rect(). unit: of x.
void draw_log_plot(const char* name, const std::vector<LogSeries>& series, double slope, const char* unit, float height);

}  // namespace clarity::ui
