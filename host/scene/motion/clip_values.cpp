#include "scene/motion/clip_values.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.hpp"
#include "scene/motion/curve.hpp"

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

}  // namespace clarity
