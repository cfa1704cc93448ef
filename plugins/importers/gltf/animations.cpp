#include "animations.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "../common/keys.hpp"
#include "tolerant.hpp"

namespace gltf_import {
namespace {

enum class Path { translation, rotation, scale, weights };

Path path_of(const Value& target) {
    const std::string path = target["path"].text();
    if (path == "translation") return Path::translation;
    if (path == "rotation") return Path::rotation;
    if (path == "scale") return Path::scale;
    if (path == "weights") return Path::weights;
    target["path"].refuse("'translation', 'rotation', 'scale' or 'weights'");
}

// The keys of a sampler. A cubic one has three elements a key: tangent in, value, tangent out.
struct Sampler {
    std::vector<double> times;
    std::vector<float> values;
    size_t width = 0;  // numbers of an element
    bool is_cubic = false, is_step = false;
    double value(size_t key, size_t k, int part) const {
        return values[((is_cubic ? 3 * key + size_t(part) : key) * width) + k];
    }
};

std::vector<double> read_times(const Value& input, Accessors& accessors) {
    const Elements<float> times = accessors.floats(input, "SCALAR");
    if (times.count == 0) input.refuse("an accessor without elements", "a key or more");
    for (size_t i = 0; i < times.count; ++i) {
        const float t = times.values[i], before = i > 0 ? times.values[i - 1] : t;
        if (!std::isfinite(t) || t < before)
            input.refuse(
                "the time " + std::to_string(t) + " s of key " + std::to_string(i) + " after " + std::to_string(before) + " s",
                "times that increase");
    }
    return {times.values.begin(), times.values.end()};
}

Sampler read_sampler(const Value& sampler, std::vector<double> times, const char* types, size_t width, Accessors& accessors) {
    Sampler out;
    const std::string how = sampler.text("interpolation", "LINEAR");
    out.is_cubic = how == "CUBICSPLINE";
    out.is_step = how == "STEP";
    if (!out.is_cubic && !out.is_step && how != "LINEAR") sampler["interpolation"].refuse("'LINEAR', 'STEP' or 'CUBICSPLINE'");
    out.times = std::move(times);
    const bool is_list = types == std::string_view("SCALAR");  // the weights of all morphs, one after the other
    out.width = width;
    const uint64_t elements = out.times.size() * (out.is_cubic ? 3 : 1) * (is_list ? width : 1);
    out.values = accessors.floats(sampler["output"], types, elements).values;
    return out;
}

class Clip {
 public:
    Clip(rt_u32 id, const rt_scene_sink& sink) : id_(id), sink_(sink) {}

    // Adds one channel with `count` numbers of each element, from the number `first` on. They are interpolated together.
    void add(const Sampler& sampler, rt_u32 moves, rt_u32 target, rt_u32 component, size_t first, size_t count) const {
        const size_t key_count = sampler.times.size();
        importers::Keys keys;
        keys.times = sampler.times;
        for (size_t key = 0; key < key_count; ++key) {
            // A Hermite spline as a Bezier curve: its handles are as long as a third of the span, in time and along the
            // tangent.
            const double before = key > 0 ? sampler.times[key] - sampler.times[key - 1] : 0;
            const double after = key + 1 < key_count ? sampler.times[key + 1] - sampler.times[key] : 0;
            for (size_t k = first; k < first + count; ++k) {
                keys.values.push_back(sampler.value(key, k, 1));
                if (!sampler.is_cubic) continue;
                keys.handles.insert(keys.handles.end(), {before / 3, before / 3 * sampler.value(key, k, 0), after / 3,
                                                         after / 3 * sampler.value(key, k, 2)});
            }
        }
        if (sampler.is_cubic || sampler.is_step) keys.spans.assign(key_count, sampler.is_cubic ? RT_SPAN_CUBIC : RT_SPAN_STEP);
        keys.pass(importers::channel(id_, 0, moves, target, component), sink_);
    }
    void add_vector(const Sampler& sampler, rt_u32 moves, rt_u32 target) const {
        for (rt_u32 k = 0; k < 3; ++k) add(sampler, moves, target, k, k, 1);
    }

 private:
    rt_u32 id_;
    const rt_scene_sink& sink_;
};

class Animation {
 public:
    Animation(const Value& animation, Accessors& accessors, const NodeTree& tree, const Meshes& meshes,
              const rt_scene_sink& sink)
        : animation_(animation), accessors_(accessors), tree_(tree), meshes_(meshes), sink_(sink) {}

    void add() {
        const Value samplers = animation_["samplers"], channels = animation_["channels"];
        for (size_t i = 0; i < channels.size(); ++i)
            spared(sink_, "the channel is left out", [&] { read_channel(channels[i], samplers); });
        if (channels_.empty()) {
            rt::warn(sink_, animation_.path() + ": found no channel that moves something; the animation is left out");
            return;
        }
        double begin = channels_.front().keys.times.front(), end = begin;
        for (const Channel& channel : channels_) {
            begin = std::min(begin, channel.keys.times.front());
            end = std::max(end, channel.keys.times.back());
        }
        const std::string name = animation_.name();
        rt_clip_desc out{};
        out.struct_bytes = sizeof out;
        out.name = name.empty() ? nullptr : name.c_str();
        out.begin_s = begin;
        out.end_s = end;
        const Clip clip(rt::id(sink_.clip(sink_.ctx, &out)), sink_);
        for (const Channel& channel : channels_) pass(channel, clip);
    }

 private:
    struct Channel {
        size_t node = 0;
        Path path = Path::translation;
        Sampler keys;
    };

    void read_channel(const Value& channel, const Value& samplers) {
        const Value target = channel["target"];
        if (target.text("path", "") == "pointer") {
            rt::warn(sink_, target.path() + " moves what KHR_animation_pointer names; it is left out");
            return;
        }
        const auto node = target.index("node", tree_.list());
        if (!node) target.refuse("no member 'node'", "the node that it moves");
        Channel out;
        out.node = *node;
        out.path = path_of(target);
        if (seen_.count({out.node, out.path}) > 0)
            target.refuse("a second channel for the " + target["path"].text() + " of " + tree_.list()[*node].path(), "one");
        const Value sampler = samplers[channel["sampler"].index(samplers)];
        const size_t morph_count = meshes_.morphs(*node).size();
        if (out.path == Path::weights && morph_count == 0) return;  // it moves a mesh that is not shown
        const auto read = [&](const char* types, size_t width) {
            out.keys = read_sampler(sampler, read_times(sampler["input"], accessors_), types, width, accessors_);
        };
        if (out.path == Path::weights)
            read("SCALAR", morph_count);
        else
            out.path == Path::rotation ? read("VEC4", 4) : read("VEC3", 3);
        seen_.insert({out.node, out.path});
        channels_.push_back(std::move(out));
    }

    void pass(const Channel& channel, const Clip& clip) const {
        const rt_u32 id = tree_.id(channel.node);
        if (channel.path == Path::translation) clip.add_vector(channel.keys, RT_MOVES_TRANSLATION, id);
        if (channel.path == Path::scale) clip.add_vector(channel.keys, RT_MOVES_SCALE, id);
        if (channel.path == Path::rotation) clip.add(channel.keys, RT_MOVES_ROTATION, id, RT_ALL_COMPONENTS, 0, 4);
        if (channel.path != Path::weights) return;
        const std::vector<rt_u32>& morphs = meshes_.morphs(channel.node);
        for (size_t k = 0; k < morphs.size(); ++k) clip.add(channel.keys, RT_MOVES_MORPH, morphs[k], 0, k, 1);
    }

    const Value animation_;
    Accessors& accessors_;
    const NodeTree& tree_;
    const Meshes& meshes_;
    const rt_scene_sink& sink_;
    std::vector<Channel> channels_;
    std::set<std::pair<size_t, Path>> seen_;
};

}  // namespace

std::set<size_t> nodes_with_animated_weights(const Document& document) {
    std::set<size_t> nodes;
    const Value list = document.list("nodes");
    if (!document.root().has("animations") || !document.root()["animations"].json().is_array()) return nodes;
    const Value animations = document.list("animations");
    for (size_t i = 0; i < animations.size(); ++i) {
        try {
            const Value channels = animations[i]["channels"];
            for (size_t k = 0; k < channels.size(); ++k) {
                try {
                    const Value target = channels[k]["target"];
                    const auto node = target.index("node", list);
                    if (node && path_of(target) == Path::weights) nodes.insert(*node);
                } catch (const Error&) {  // add_animations() says so
                }
            }
        } catch (const Error&) {  // add_animations() says so
        }
    }
    return nodes;
}

void add_animations(const Document& document, Accessors& accessors, const NodeTree& tree, const Meshes& meshes,
                    const rt_scene_sink& sink) {
    const Value animations = spared_list(document, "animations", sink);
    for (size_t i = 0; i < animations.size(); ++i)
        spared(sink, "the animation is left out", [&] { Animation(animations[i], accessors, tree, meshes, sink).add(); });
}

}  // namespace gltf_import
