#include "emit_motion.hpp"

#include <algorithm>
#include <cmath>

#include "../common/numbers.hpp"

namespace scene_format {
namespace {

// Keys of a rotation about one axis turn at constant speed, also further than half a turn. Quaternions take the shorter way
// between two keys, so further keys come in between.
constexpr double kMostDegrees = 60;

struct Keys {
    std::vector<double> times, values;
};

Keys component_keys(const Animation& animation, size_t component) {
    Keys keys;
    for (size_t k = 0; k < animation.key_count(); ++k) {
        keys.times.push_back(double{animation.numbers[4 * k]});
        keys.values.push_back(double{animation.numbers[4 * k + 1 + component]});
    }
    return keys;
}

Keys rotation_keys(const Animation& animation) {
    Keys keys;
    const auto add = [&](double time, const Vec3& axis, double degrees) {
        const std::array<double, 4> q = quaternion_about(axis, degrees);
        keys.times.push_back(time);
        keys.values.insert(keys.values.end(), q.begin(), q.end());
    };
    const float* last = nullptr;
    for (size_t k = 0; k < animation.key_count(); ++k) {
        const float* key = &animation.numbers[5 * k];
        const Vec3 axis = {key[1], key[2], key[3]};
        if (last && std::equal(last + 1, last + 4, key + 1)) {
            const double from = double{last[4]}, turn = double{key[4]} - from;
            const double steps = std::ceil(std::abs(turn) / kMostDegrees);
            for (double step = 1; step < steps && step < 1e4; ++step)
                add(last[0] + (double{key[0]} - last[0]) * step / steps, axis, from + turn * step / steps);
        }
        add(double{key[0]}, axis, double{key[4]});
        last = key;
    }
    return keys;
}

template <class Things>
auto find(const Things& things, const std::string& name) {
    const auto at = std::find_if(things.begin(), things.end(), [&](const auto& thing) { return thing.name.text == name; });
    return at == things.end() ? nullptr : &*at;
}

// Delivers a channel with these keys.
bool deliver(const rt_scene_sink& sink, rt_channel_desc channel, const Keys& keys) {
    channel.struct_bytes = sizeof channel;
    channel.key_count = keys.times.size();
    channel.times_s = keys.times.data();
    channel.values = keys.values.data();
    return sink.channel(sink.ctx, &channel) == RT_OK;
}

}  // namespace

rt_u32 MotionEmitter::node_of(const Name& name) const {
    const auto known = name.text.empty() ? nodes_.end() : nodes_.find(name.text);
    return known == nodes_.end() ? 0 : known->second;
}

rt_u32 MotionEmitter::add_node(const std::string& name) const {
    rt_node_desc node{};
    node.struct_bytes = sizeof node;
    node.name = name.c_str();
    node.rotation_order = RT_ROTATE_QUATERNION;
    node.rotation[3] = 1;
    for (double& s : node.scale) s = 1;
    if (const Load* load = find(document_.loads, name)) {
        const StatedTransform& placement = load->placement;
        std::copy(placement.translation().begin(), placement.translation().end(), node.translation);
        std::copy(placement.quaternion().begin(), placement.quaternion().end(), node.rotation);
        std::copy(placement.scales().begin(), placement.scales().end(), node.scale);
    } else if (const Camera* camera = find(document_.cameras, name)) {
        std::copy(camera->eye.begin(), camera->eye.end(), node.translation);
    } else if (const Light* light = find(document_.lights, name)) {
        std::copy_n(light->values.position, 3, node.translation);
    }
    return sink_.node(sink_.ctx, &node);
}

bool MotionEmitter::add_channels(const Animation& animation, rt_u32 node, rt_u32 clip) const {
    rt_channel_desc channel{};
    channel.clip = clip;
    channel.target = node;
    channel.moves = RT_MOVES_ROTATION;
    channel.component = RT_ALL_COMPONENTS;
    if (animation.motion == Animation::Motion::rotate) return deliver(sink_, channel, rotation_keys(animation));
    channel.moves = animation.motion == Animation::Motion::scale ? RT_MOVES_SCALE : RT_MOVES_TRANSLATION;
    for (channel.component = 0; channel.component < 3; ++channel.component)
        if (!deliver(sink_, channel, component_keys(animation, channel.component))) return false;
    return true;
}

bool MotionEmitter::emit_fov(const Camera& camera, rt_u32 id) const {
    if (clip_ == RT_NONE) return true;
    for (const Animation& animation : document_.animations) {
        if (animation.motion != Animation::Motion::fov || animation.target.text != camera.name.text) continue;
        Keys keys;
        for (size_t k = 0; k < animation.key_count(); ++k) {
            keys.times.push_back(double{animation.numbers[2 * k]});
            keys.values.push_back(double{animation.numbers[2 * k + 1]} * importers::kRadPerDegree);
        }
        rt_channel_desc channel{};
        channel.clip = clip_;
        channel.moves = RT_MOVES_FOV;
        channel.target = id;
        if (!deliver(sink_, channel, keys)) return false;
    }
    return true;
}

bool MotionEmitter::emit() {
    if (document_.animations.empty()) return true;
    if (!RT_HAS(&sink_, rt_scene_sink, vertex_frames)) {
        sink_.warn(sink_.ctx, "this host is older than motion: `animate` is ignored, the scene is shown at rest");
        return true;
    }
    rt_clip_desc clip{};
    clip.struct_bytes = sizeof clip;
    clip.name = "animate";
    clip.begin_s = double{document_.animations.front().numbers.front()};
    clip.end_s = clip.begin_s;
    for (const Animation& animation : document_.animations) {
        const size_t last = animation.numbers.size() - animation.numbers_per_key();
        clip.begin_s = std::min(clip.begin_s, double{animation.numbers.front()});
        clip.end_s = std::max(clip.end_s, double{animation.numbers[last]});
    }
    clip_ = sink_.clip(sink_.ctx, &clip);
    if (clip_ == RT_NONE) return false;
    for (const Animation& animation : document_.animations) {
        if (animation.motion == Animation::Motion::fov) continue;
        const std::string& name = animation.target.text;
        auto [known, is_new] = nodes_.emplace(name, 0);
        if (is_new) known->second = add_node(name);
        if (known->second == RT_NONE || !add_channels(animation, known->second, clip_)) return false;
    }
    return true;
}

}  // namespace scene_format
