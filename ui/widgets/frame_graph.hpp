// frame_graph.hpp -- times of frames over time: what is drawn in the Stats tab.
#pragma once
#include <string>
#include <vector>

namespace clarity::ui {

// The value that `share` of the values do not exceed, by nearest rank: 0.5 is the median. 0 of nothing.
float percentile(std::vector<float> values, double share);
// Upper end of an axis that holds `value`: 1, 2 or 5 times a power of ten.
float axis_end(float value);

struct FrameSeries {
    std::string name;
    std::vector<float> ms;  // oldest first
    unsigned color = 0;     // packed as ImGui has it
};
// target_ms: a line across; 0: none.
void draw_frame_graph(const std::vector<FrameSeries>& series, float target_ms, float height);

}  // namespace clarity::ui
