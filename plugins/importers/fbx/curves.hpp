// curves.hpp -- keys of one number over time, as the host takes them.
#pragma once
#include "scene.hpp"

namespace fbx_import {

struct Curve {
    std::vector<double> times, values;
    std::vector<uint8_t> spans;   // RT_SPAN_...
    std::vector<double> handles;  // in seconds, in value, out seconds, out value, of each key
    rt_u32 before = RT_OUTSIDE_HOLD, after = RT_OUTSIDE_HOLD, before_count = 0, after_count = 0;

    static Curve constant(double value) { return {{0}, {value}, {RT_SPAN_STEP}, {}}; }
    void scale(double by);  // all values
};

// Ticks of the file's clock in a second.
double ticks_of_second(const Document& document);
// The curve of an AnimationCurve (version 7), or of a channel in a take (before). No keys: there are none, or they are damaged,
// of which the caller is told by an exception.
Curve read_curve(const Document& document, const Node& node, double ticks);
Curve read_take_curve(const Document& document, const Node& channel, double ticks);

}  // namespace fbx_import
