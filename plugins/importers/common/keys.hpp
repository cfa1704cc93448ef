// keys.hpp -- what moves a scene, as the host takes it: keys of a channel, and skins. For importers.
#pragma once
#include <vector>

#include "rt_plugin.hpp"

namespace importers {

// The keys of a channel, in rt_channel_desc's words.
struct Keys {
    std::vector<double> times, values;
    std::vector<uint8_t> spans;   // RT_SPAN_...; empty: all are linear
    std::vector<double> handles;  // in seconds, in value, out seconds, out value, of each value; empty: no span is cubic
    rt_u32 before = RT_OUTSIDE_HOLD, after = RT_OUTSIDE_HOLD, before_count = 0, after_count = 0;

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

}  // namespace importers
