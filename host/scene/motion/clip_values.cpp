#include "scene/motion/clip_values.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.hpp"

namespace clarity {
namespace {

// The power that keeps the sign of mirrored scales.
double power(double base, double exponent) {
    return std::copysign(std::pow(std::abs(base), exponent), base);
}

// The values that one layer gives to one property of a node. A component without a channel keeps the value of the layers below;
// in a layer that adds, it adds nothing.
struct Keyed {
    Vec value{};
    bool has[3] = {false, false, false};
};

Vec with_rest(const Keyed& keyed, const Vec& otherwise) {
    return {keyed.has[0] ? keyed.value[0] : otherwise[0], keyed.has[1] ? keyed.value[1] : otherwise[1],
            keyed.has[2] ? keyed.value[2] : otherwise[2]};
}

// A layer at one time. How it combines rotations and scales follows FBX: "FbxAnimLayer" of the SDK's help.
struct LayerNow {
    rt_u32 mode = RT_LAYER_REPLACES, flags = 0;
    double weight = 1;
    bool replaces() const { return mode == RT_LAYER_REPLACES; }

    double number(double below, double value) const {
        if (replaces()) return value;
        return mode == RT_LAYER_ADDS ? below + value * weight : below + (value - below) * weight;
    }
    Vec numbers(const Vec& below, const Keyed& keyed) const {
        const Vec value = with_rest(keyed, mode == RT_LAYER_ADDS ? Vec{} : below);
        return {number(below[0], value[0]), number(below[1], value[1]), number(below[2], value[2])};
    }
    Vec scales(const Vec& below, const Keyed& keyed) const {
        if (replaces() || (flags & RT_LAYER_ADDS_SCALES)) return numbers(below, keyed);
        Vec result{};
        const Vec value = with_rest(keyed, mode == RT_LAYER_ADDS ? Vec{1, 1, 1} : below);
        for (int i = 0; i < 3; ++i) {
            const double kept = mode == RT_LAYER_ADDS ? below[i] : power(below[i], 1 - weight);
            result[i] = kept * power(value[i], weight);
        }
        return result;
    }
    Quaternion turned(const Quaternion& below, const Quaternion& value) const {
        if (replaces()) return value;
        return mode == RT_LAYER_ADDS ? below * slerp(kNoRotation, value, weight) : slerp(below, value, weight);
    }
    Vec angles(const Vec& below, const Keyed& keyed, rt_u32 order) const {
        if (replaces() || (flags & RT_LAYER_ROTATES_BY_CHANNEL)) return numbers(below, keyed);
        const Vec value = with_rest(keyed, mode == RT_LAYER_ADDS ? Vec{} : below);
        return to_angles(turned(from_angles(below, order), from_angles(value, order)), order);
    }
};

// Applies one layer to one thing that it moves. Channels [begin, end) are those of the thing.
void apply(const Scene& scene, const Channel* begin, const Channel* end, const LayerNow& layer, double time_s,
           MovingValues& values) {
    const Motion& motion = scene.motion;
    const rt_u32 target = begin->target;
    if (begin->component == RT_ALL_COMPONENTS) {
        NodeValues& node = values.nodes[target];
        node.rotation = layer.turned(node.rotation, quaternion_at(motion, *begin, time_s));
        return;
    }
    Keyed keyed;
    for (const Channel* c = begin; c != end; ++c) {
        if (c->component >= 3) continue;
        keyed.value[c->component] = value_at(motion, *c, time_s);
        keyed.has[c->component] = true;
    }
    switch (begin->moves) {
        case RT_MOVES_TRANSLATION:
            values.nodes[target].translation = layer.numbers(values.nodes[target].translation, keyed);
            break;
        case RT_MOVES_ROTATION: {
            const rt_u32 order = motion.nodes[target].values.rotation_order;
            values.nodes[target].degrees = layer.angles(values.nodes[target].degrees, keyed, order);
            break;
        }
        case RT_MOVES_SCALE:
            values.nodes[target].scale = layer.scales(values.nodes[target].scale, keyed);
            break;
        case RT_MOVES_VISIBILITY:
            values.nodes[target].visible = keyed.value[0] >= 0.5;
            break;
        case RT_MOVES_MORPH:
            values.morph_weights[target] = layer.number(values.morph_weights[target], keyed.value[0]);
            break;
        case RT_MOVES_FOV: {
            const auto fov = static_cast<float>(layer.number(values.fovs[target], keyed.value[0]));
            if (fov > 1e-3f && fov < 3.14f) values.fovs[target] = fov;
            break;
        }
        case RT_MOVES_COLOR: {
            std::array<float, 3>& color = values.colors[target];
            const Vec moved = layer.numbers({color[0], color[1], color[2]}, keyed);
            for (int i = 0; i < 3; ++i) color[i] = static_cast<float>(moved[i]);
            break;
        }
        default:
            break;
    }
}

LayerNow layer_now(const Motion& motion, const Clip& clip, rt_u32 number, const std::map<rt_u32, double>& weights) {
    LayerNow now;
    if (number >= clip.layer_count) return now;
    const rt_layer& layer = motion.layers[clip.first_layer + number];
    const auto keyed = weights.find(number);
    now.flags = layer.flags;
    now.weight = std::clamp(keyed == weights.end() ? layer.weight : keyed->second, 0.0, 1.0);
    // The first layer has nothing below it.
    now.mode = number == 0 ? rt_u32(RT_LAYER_REPLACES) : layer.mode;
    return now;
}

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

MovingValues values_at_rest(const Scene& scene) {
    MovingValues values;
    for (const Node& node : scene.motion.nodes) values.nodes.push_back(values_at_rest(node.values));
    for (const Morph& morph : scene.motion.morphs) values.morph_weights.push_back(morph.weight);
    for (const Camera& camera : scene.cameras) values.fovs.push_back(camera.fov_y_rad);
    for (const Light& light : scene.lights)
        values.colors.push_back({light.values.color[0], light.values.color[1], light.values.color[2]});
    return values;
}

std::vector<bool> acting_clips(const Motion& motion, const std::string& name) {
    const std::string wanted = name.empty() && !motion.clips.empty() ? motion.clips.front().name : name;
    std::map<rt_u32, size_t> of_rig;
    bool found = false;
    for (size_t i = 0; i < motion.clips.size(); ++i) {
        const Clip& clip = motion.clips[i];
        const auto known = of_rig.emplace(clip.rig, i).first;
        if (clip.name != wanted) continue;
        found = true;
        if (motion.clips[known->second].name != wanted) known->second = i;
    }
    if (!found) {
        std::string names;
        for (const Clip& clip : motion.clips) names += (names.empty() ? "" : ", ") + clip.name;
        throw Error(Exit::usage,
                    "--clip " + name + ": " +
                        (names.empty() ? "the scene has no clips" : "the scene has no such clip; it has " + names));
    }
    std::vector<bool> acts(motion.clips.size(), false);
    for (const auto& [rig, clip] : of_rig) acts[clip] = true;
    return acts;
}

void play(const Scene& scene, const std::string& clip, double time_s, MovingValues& values) {
    const Motion& motion = scene.motion;
    const std::vector<bool> acts = acting_clips(motion, clip);
    const std::vector<Channel>& channels = motion.channels;
    std::map<rt_u32, std::map<rt_u32, double>> weights;  // of layers, by clip
    for (const Channel& c : channels)
        if (c.moves == RT_MOVES_LAYER && acts[c.clip]) weights[c.clip][c.target] = value_at(motion, c, time_s);
    for (size_t i = 0; i < channels.size();) {
        const Channel& first = channels[i];
        size_t end = i + 1;
        while (end < channels.size() && channels[end].clip == first.clip && channels[end].layer == first.layer &&
               channels[end].moves == first.moves && channels[end].target == first.target)
            ++end;
        if (acts[first.clip]) {
            const LayerNow layer = layer_now(motion, motion.clips[first.clip], first.layer, weights[first.clip]);
            apply(scene, &channels[i], &channels[i] + (end - i), layer, time_s, values);
        }
        i = end;
    }
}

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
