#include "scene/motion/curve.hpp"

#include <algorithm>
#include <cmath>

namespace clarity {
namespace {

struct Keys {
    Keys(const Motion& motion, const Channel& channel)
        : times(&motion.key_times[channel.first_key]),
          values(&motion.key_values[channel.first_value]),
          handles(channel.has_handles ? &motion.key_handles[channel.first_handle] : nullptr),
          spans(&motion.key_spans[channel.first_key]),
          count(channel.key_count) {}
    const double *times, *values, *handles;
    const uint8_t* spans;
    uint64_t count;
};

// A time within the keys, and what is added to the value there.
struct Inside {
    double time_s;
    double added = 0;
    double slope_s = 0;  // seconds beyond the first or last key, along whose slope the curve goes on
};

// Maps a time before the first key or after the last one into the keys.
Inside inside(const Keys& keys, const Channel& channel, double time_s) {
    const double begin = keys.times[0], end = keys.times[keys.count - 1], length = end - begin;
    if (time_s >= begin && time_s <= end) return {time_s};
    const bool is_before = time_s < begin;
    const rt_u32 how = is_before ? channel.before : channel.after;
    const rt_u32 most = is_before ? channel.before_count : channel.after_count;
    const double edge = is_before ? begin : end, beyond = is_before ? begin - time_s : time_s - end;
    if (how == RT_OUTSIDE_HOLD || !(length > 0) || !std::isfinite(time_s)) return {edge};
    if (how == RT_OUTSIDE_SLOPE) return {edge, 0, time_s - edge};
    double turns = std::floor(beyond / length),
           rest = beyond - turns * length;  // whole repetitions, and the part of the next one
    if (most > 0 && turns >= most) {
        turns = most - 1.0;
        rest = length;
    }
    Inside result{is_before ? end - rest : begin + rest};
    if (how == RT_OUTSIDE_MIRROR && std::fmod(turns, 2) == 0) result.time_s = is_before ? begin + rest : end - rest;
    if (how == RT_OUTSIDE_REPEAT_RELATIVE)
        result.added = (is_before ? -1 : 1) * (turns + 1) * (keys.values[keys.count - 1] - keys.values[0]);
    return result;
}

// The key at or before a time within the keys; the last key only if there is no other.
uint64_t span_of(const Keys& keys, double time_s) {
    const double* after = std::upper_bound(keys.times, keys.times + keys.count, time_s);
    const uint64_t key = after == keys.times ? 0 : static_cast<uint64_t>(after - keys.times) - 1;
    return key + 1 == keys.count && key > 0 && keys.times[key] > time_s ? key - 1 : key;
}

double bezier(double a, double b, double c, double d, double s) {
    const double r = 1 - s;
    return r * r * r * a + 3 * r * r * s * b + 3 * r * s * s * c + s * s * s * d;
}

// The parameter at which a Bezier curve in time, from 0 to 1 with inner points x1 and x2 there, reaches x. The curve rises, so
// bisection always finds it; Newton's steps only make it faster.
double parameter_at(double x, double x1, double x2) {
    // Where the handles are a third of the span, as those of Hermite curves, time is the parameter.
    if (std::abs(x1 - 1.0 / 3) < 1e-12 && std::abs(x2 - 2.0 / 3) < 1e-12) return x;
    double low = 0, high = 1, s = x;
    for (int step = 0; step < 80; ++step) {
        const double error = bezier(0, x1, x2, 1, s) - x;
        if (std::abs(error) < 1e-15) break;
        (error > 0 ? high : low) = s;
        const double r = 1 - s, slope = 3 * (r * r * x1 + 2 * r * s * (x2 - x1) + s * s * (1 - x2));
        const double newton = s - error / slope;
        s = slope > 1e-9 && newton > low && newton < high ? newton : 0.5 * (low + high);
    }
    return s;
}

// Number `component` of `width` between key i and the next one. x: 0..1 in time.
double cubic(const Keys& keys, uint64_t i, rt_u32 component, rt_u32 width, double x) {
    const double span = keys.times[i + 1] - keys.times[i];
    const double *out = &keys.handles[4 * (i * width + component)], *in = &keys.handles[4 * ((i + 1) * width + component)];
    // A handle that reaches beyond its span would make the curve run backwards in time.
    const double x1 = std::clamp(out[2] / span, 0.0, 1.0), x2 = 1 - std::clamp(in[0] / span, 0.0, 1.0);
    const double from = keys.values[i * width + component], to = keys.values[(i + 1) * width + component];
    return bezier(from, from + out[3], to - in[1], to, parameter_at(x, x1, x2));
}

double number_in_span(const Keys& keys, uint64_t i, double time_s) {
    if (i + 1 >= keys.count) return keys.values[i];
    const double span = keys.times[i + 1] - keys.times[i];
    const double from = keys.values[i], to = keys.values[i + 1], x = span > 0 ? (time_s - keys.times[i]) / span : 1;
    switch (keys.spans[i]) {
        case RT_SPAN_STEP:
            return x < 1 ? from : to;
        case RT_SPAN_STEP_NEXT:
            return x > 0 ? to : from;
        case RT_SPAN_CUBIC:
            if (keys.handles && span > 0) return cubic(keys, i, 0, 1, x);
            [[fallthrough]];
        default:
            return from + (to - from) * x;
    }
}

// Units a second at the first or last key, on the side of the other keys.
double slope_at_edge(const Keys& keys, bool first) {
    const uint64_t i = first ? 0 : keys.count - 2;
    const double span = keys.times[i + 1] - keys.times[i];
    if (keys.spans[i] == RT_SPAN_STEP || keys.spans[i] == RT_SPAN_STEP_NEXT || !(span > 0)) return 0;
    if (keys.spans[i] == RT_SPAN_CUBIC && keys.handles) {
        const double* handle = &keys.handles[first ? 4 * i + 2 : 4 * (i + 1)];
        return handle[0] > 0 ? handle[1] / handle[0] : 0;
    }
    return (keys.values[i + 1] - keys.values[i]) / span;
}

}  // namespace

double value_at(const Motion& motion, const Channel& channel, double time_s) {
    const Keys keys(motion, channel);
    if (keys.count == 1) return keys.values[0];
    const Inside at = inside(keys, channel, time_s);
    const double value = number_in_span(keys, span_of(keys, at.time_s), at.time_s) + at.added;
    return at.slope_s == 0 ? value : value + at.slope_s * slope_at_edge(keys, at.slope_s < 0);
}

Quaternion quaternion_at(const Motion& motion, const Channel& channel, double time_s) {
    const Keys keys(motion, channel);
    const auto key = [&](uint64_t i) {
        return unit({keys.values[4 * i], keys.values[4 * i + 1], keys.values[4 * i + 2], keys.values[4 * i + 3]});
    };
    if (keys.count == 1) return key(0);
    const double at = inside(keys, channel, time_s).time_s;
    const uint64_t i = span_of(keys, at);
    if (i + 1 >= keys.count) return key(i);
    const double span = keys.times[i + 1] - keys.times[i], x = span > 0 ? (at - keys.times[i]) / span : 1;
    if (keys.spans[i] == RT_SPAN_STEP) return key(x < 1 ? i : i + 1);
    if (keys.spans[i] == RT_SPAN_STEP_NEXT) return key(x > 0 ? i + 1 : i);
    if (keys.spans[i] == RT_SPAN_CUBIC && keys.handles && span > 0) {
        Quaternion q{};
        for (rt_u32 c = 0; c < 4; ++c) q[c] = cubic(keys, i, c, 4, x);
        return unit(q);
    }
    return slerp(key(i), key(i + 1), x);
}

}  // namespace clarity
