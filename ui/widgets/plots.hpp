// plots.hpp -- the graph of frame times in the Stats tab.
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace clarity::ui {

// The percentile by nearest rank: the smallest value that at least `share` of the values do not exceed (0.5: the median). 0
// without values.
float percentile(std::vector<float> values, double share);
// The upper end of an axis which covers `value`: 1, 2 or 5 times a power of ten.
float axis_end(float value);

struct FrameSeries {
    std::string name;
    std::vector<float> ms;  // oldest first
    unsigned color = 0;     // packed as ImGui does
};
// Draws the graph. target_ms: a dashed line across it; 0: none.
void draw_frame_graph(const std::vector<FrameSeries>& series, float target_ms, float height);

// A graph with logarithmic axes.

struct LogSeries {
    std::vector<std::pair<double, double>> points;  // x and y, both above 0
    unsigned color = 0;                             // packed as ImGui does
};
// A dashed line goes through the first point of the first series with this slope. name: for note_rect(). unit: of x.
void draw_log_plot(const char* name, const std::vector<LogSeries>& series, double slope, const char* unit, float height);

}  // namespace clarity::ui
