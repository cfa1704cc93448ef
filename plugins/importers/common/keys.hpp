// keys.hpp -- what moves a scene, as the host takes it: keys of a channel, skins, morphs and geometry caches. For importers.
#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "rt_plugin.hpp"

namespace importers {

// The keys of a channel, in rt_channel_desc's words.
struct Keys {
    std::vector<double> times, values;
    std::vector<uint8_t> spans;   // RT_SPAN_...; empty: all are linear
    std::vector<double> handles;  // in seconds, in value, out seconds, out value, of each value; empty: no span is cubic
    rt_u32 before = RT_OUTSIDE_HOLD, after = RT_OUTSIDE_HOLD, before_count = 0, after_count = 0;

    // One value at all times.
    static Keys constant(double value) {
        Keys keys;
        keys.times = {0};
        keys.values = {value};
        keys.spans = {RT_SPAN_STEP};
        return keys;
    }
    // Applies a function to all values, and to the ends of their handles.
    template <class Function>
    void convert(const Function& function) {
        for (size_t i = 0; i < values.size(); ++i) {
            const double before = values[i];
            values[i] = function(before);
            if (handles.empty()) continue;
            handles[4 * i + 1] = values[i] - function(before - handles[4 * i + 1]);
            handles[4 * i + 3] = function(before + handles[4 * i + 3]) - values[i];
        }
    }
    // Whether all numbers are finite, and the times in order.
    bool is_sound() const {
        const auto are_finite = [](const std::vector<double>& numbers) {
            return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
        };
        return are_finite(times) && are_finite(values) && are_finite(handles) && std::is_sorted(times.begin(), times.end());
    }
    // Passes the keys as a channel. Of `channel`, the caller sets what they move.
    void pass(rt_channel_desc channel, const rt_scene_sink& sink) const {
        channel.struct_bytes = sizeof channel;
        channel.key_count = times.size();
        channel.times_s = times.data();
        channel.values = values.data();
        channel.spans = spans.empty() ? nullptr : spans.data();
        channel.handles = handles.empty() ? nullptr : handles.data();
        channel.before = before;
        channel.after = after;
        channel.before_count = before_count;
        channel.after_count = after_count;
        if (sink.channel(sink.ctx, &channel) != RT_OK) throw rt::Stopped();
    }
};
inline rt_channel_desc channel(rt_u32 clip, rt_u32 layer, rt_u32 moves, rt_u32 target, rt_u32 component) {
    rt_channel_desc out{};
    out.clip = clip;
    out.layer = layer;
    out.moves = moves;
    out.target = target;
    out.component = component;
    return out;
}

struct Skin {
    rt_u32 method = RT_SKIN_LINEAR;
    std::vector<rt_bone> bones;
    std::vector<rt_weight> weights;
    std::vector<float> dual_quaternion_shares;  // of each vertex, or empty

    void pass(rt_u32 mesh, const rt_scene_sink& sink) const {
        rt_skin_desc out{};
        out.struct_bytes = sizeof out;
        out.mesh = mesh;
        out.bone_count = static_cast<rt_u32>(bones.size());
        out.method = method;
        out.bones = bones.data();
        out.weights = weights.data();
        out.weight_count = weights.size();
        out.dual_quaternion_shares = dual_quaternion_shares.empty() ? nullptr : dual_quaternion_shares.data();
        if (sink.skin(sink.ctx, &out) != RT_OK) throw rt::Stopped();
    }
};

// Offsets of vertices that are added to a mesh, at weights between 0 and 1 or beyond.
struct Morph {
    struct Target {
        double weight = 1;  // at which the mesh has reached it
        std::vector<rt_u32> vertices;
        std::vector<float> positions, normals;  // 3 offsets of each; normals may be empty
        // normal: nullptr if there is none.
        void add(rt_u32 vertex, const float* position, const float* normal) {
            vertices.push_back(vertex);
            positions.insert(positions.end(), position, position + 3);
            if (normal) normals.insert(normals.end(), normal, normal + 3);
        }
    };
    std::string name;
    double weight = 0;
    std::vector<Target> targets;

    // Returns the host's id.
    rt_u32 pass(rt_u32 mesh, const rt_scene_sink& sink) {
        std::stable_sort(targets.begin(), targets.end(), [](const auto& a, const auto& b) { return a.weight < b.weight; });
        std::vector<rt_morph_target> passed;
        for (const Target& target : targets) {
            passed.push_back({});
            passed.back().weight = target.weight;
            passed.back().vertices = target.vertices.data();
            passed.back().count = target.vertices.size();
            passed.back().positions = target.positions.data();
            passed.back().normals = target.normals.empty() ? nullptr : target.normals.data();
        }
        rt_morph_desc out{};
        out.struct_bytes = sizeof out;
        out.mesh = mesh;
        out.name = name.empty() ? nullptr : name.c_str();
        out.weight = weight;
        out.targets = passed.data();
        out.target_count = static_cast<rt_u32>(passed.size());
        return rt::id(sink.morph(sink.ctx, &out));
    }
};

}  // namespace importers
