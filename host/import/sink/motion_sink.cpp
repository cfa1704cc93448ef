#include "import/sink/motion_sink.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "scene/usable.hpp"

namespace clarity::import {
namespace {

constexpr double kMostSeconds = 1e9;

[[noreturn]] void refuse(const std::string& why) {
    throw Error(Exit::import_failed, why);
}
// Fails for a bug of the plugin.
void demand(bool good, const std::string& why) {
    if (!good) refuse(why);
}
std::string of(uint64_t id, size_t count) {
    return std::to_string(id) + " of " + std::to_string(count) + " is unknown: pass an id that the sink returned";
}

bool in_order(const double* times, uint64_t count) {
    return std::all_of(times, times + count, [](double t) { return std::abs(t) <= kMostSeconds; }) &&
           std::is_sorted(times, times + count);
}

// A plugin may leave a matrix at 0 where it has none.
void fill_in(double (&matrix)[12]) {
    if (std::any_of(std::begin(matrix), std::end(matrix), [](double x) { return x != 0; })) return;
    std::copy(kIdentityMatrix.begin(), kIdentityMatrix.end(), matrix);
}

rt_u32 mesh_of(rt_u32 id, const std::vector<rt_u32>& meshes, const char* what) {
    demand(id < meshes.size(), std::string(what) + ": mesh id " + of(id, meshes.size()));
    return meshes[id];
}

template <class T>
uint64_t append(SharedArray<T>& to, const T* from, uint64_t count) {
    to.append(from, from + count);
    return to.size() - count;
}

}  // namespace

rt_u32 MotionSink::node_of(rt_u32 id, const char* what) const {
    demand(id <= content_.nodes.size(), std::string(what) + ": node id " + of(id, content_.nodes.size()));
    return id == 0 ? RT_NONE : id - 1;
}

rt_u32 MotionSink::node(const rt_node_desc& d, std::string name) {
    Node node{std::move(name), d};
    rt_node_desc& values = node.values;
    values.name = nullptr;
    values.parent = node_of(d.parent, "node");
    demand(d.rotation_order <= RT_ROTATE_QUATERNION && d.inherit <= RT_INHERIT_RRS,
           "node '" + node.name + "': rotation_order " + std::to_string(d.rotation_order) + " or inherit " +
               std::to_string(d.inherit) + " is unknown");
    for (auto* matrix : {&values.before_rotation, &values.after_rotation, &values.after_scale}) fill_in(*matrix);
    const bool good = are_usable(values.translation, 3) && are_usable(values.rotation, 4) && are_usable(values.scale, 3) &&
                      are_usable(values.before_rotation, 12) && are_usable(values.after_rotation, 12) &&
                      are_usable(values.after_scale, 12);
    if (!good) {
        const rt_u32 parent = values.parent;
        values = {};
        values.parent = parent;
        for (double& s : values.scale) s = 1;
        for (auto* matrix : {&values.before_rotation, &values.after_rotation, &values.after_scale}) fill_in(*matrix);
        ++lost_nodes_;
    }
    at_rest_.push_back(
        place_node(values, values_at_rest(values), values.parent == RT_NONE ? nullptr : &at_rest_[values.parent]));
    content_.nodes.push_back(std::move(node));
    return static_cast<rt_u32>(content_.nodes.size());
}

rt_u32 MotionSink::clip(const rt_clip_desc& d, std::string name) {
    demand(d.layer_count == 0 || d.layers, "clip '" + name + "': it has layers, but no array of them");
    Clip clip;
    clip.name = std::move(name);
    clip.first_layer = static_cast<rt_u32>(content_.layers.size());
    clip.layer_count = std::max<rt_u32>(d.layer_count, 1);
    for (rt_u32 i = 0; i < clip.layer_count; ++i) {
        rt_layer layer = d.layer_count == 0 ? rt_layer{RT_LAYER_REPLACES, 0, 1} : d.layers[i];
        demand(layer.mode <= RT_LAYER_BLENDS, "clip '" + clip.name + "': mode " + std::to_string(layer.mode) + " is unknown");
        if (!(layer.weight >= 0 && layer.weight <= 1)) layer.weight = layer.weight > 1 ? 1 : 0;
        content_.layers.push_back(layer);
    }
    const double span[2] = {d.begin_s, d.end_s};
    const bool good = std::abs(span[0]) <= kMostSeconds && std::abs(span[1]) <= kMostSeconds && span[0] <= span[1];
    if (good) clip.begin_s = d.begin_s, clip.end_s = d.end_s;
    if (d.fps > 0 && d.fps <= 1e6) clip.fps = d.fps;
    content_.clips.push_back(std::move(clip));
    content_.rig_count = std::max<rt_u32>(content_.rig_count, 1);
    return static_cast<rt_u32>(content_.clips.size());
}

void MotionSink::channel(const rt_channel_desc& d, const std::vector<rt_u32>& cameras, const std::vector<rt_u32>& lights) {
    demand(d.clip > 0 && d.clip <= content_.clips.size(), "channel: clip id " + of(d.clip, content_.clips.size()));
    const Clip& clip = content_.clips[d.clip - 1];
    demand(d.layer < clip.layer_count, "channel: layer " + std::to_string(d.layer) + ", but the clip has " +
                                           std::to_string(clip.layer_count) + " layers, numbered from 0");
    demand(d.key_count > 0 && d.times_s && d.values, "channel: it has no keys");
    Channel c;
    c.clip = d.clip - 1;
    c.layer = d.layer;
    c.moves = d.moves;
    c.target = d.target;
    c.component = d.component;
    c.before = d.before;
    c.after = d.after;
    c.before_count = d.before_count;
    c.after_count = d.after_count;
    demand(c.before <= RT_OUTSIDE_REPEAT_RELATIVE && c.after <= RT_OUTSIDE_REPEAT_RELATIVE,
           "channel: before or after is no RT_OUTSIDE_ value");
    const auto known = [&](const char* what, size_t count, rt_u32 first) {
        demand(d.target >= first && d.target - first < count, std::string("channel: ") + what + " id " + of(d.target, count));
    };
    switch (d.moves) {
        case RT_MOVES_TRANSLATION:
        case RT_MOVES_ROTATION:
        case RT_MOVES_SCALE:
        case RT_MOVES_VISIBILITY:
            known("node", content_.nodes.size(), 1);
            c.target = d.target - 1;
            break;
        case RT_MOVES_MORPH:
            known("morph", morphs_.size(), 1);
            c.target = morphs_[d.target - 1];
            break;
        case RT_MOVES_LAYER:
            demand(d.target < clip.layer_count, "channel: layer " + of(d.target, clip.layer_count));
            break;
        case RT_MOVES_FOV:
            known("camera", cameras.size(), 0);
            c.target = cameras[d.target];
            break;
        case RT_MOVES_COLOR:
            known("light", lights.size(), 0);
            c.target = lights[d.target];
            break;
        default:
            refuse("channel: moves " + std::to_string(d.moves) + " is unknown");
    }
    const bool vector = d.moves <= RT_MOVES_SCALE || d.moves == RT_MOVES_COLOR;
    demand(d.component <= (vector ? 3u : 0u), "channel: component " + std::to_string(d.component) + " does not exist");
    if (d.component == RT_ALL_COMPONENTS)
        demand(d.moves == RT_MOVES_ROTATION && content_.nodes[c.target].values.rotation_order == RT_ROTATE_QUATERNION,
               "channel: RT_ALL_COMPONENTS is for the rotation of a node with RT_ROTATE_QUATERNION");
    else if (d.moves == RT_MOVES_ROTATION)
        demand(content_.nodes[c.target].values.rotation_order != RT_ROTATE_QUATERNION,
               "channel: the rotation of a node with RT_ROTATE_QUATERNION is keyed as a whole: RT_ALL_COMPONENTS");
    const uint64_t values = d.key_count * c.width();
    if (!in_order(d.times_s, d.key_count) || !are_usable(d.values, values) ||
        (d.handles && !are_usable(d.handles, 4 * values)) || c.target == RT_NONE) {
        ++lost_channels_;
        return;
    }
    Motion& motion = scene_.motion;
    c.key_count = d.key_count;
    c.first_key = append(motion.key_times, d.times_s, d.key_count);
    c.first_value = append(motion.key_values, d.values, values);
    if (d.spans) {
        demand(std::all_of(d.spans, d.spans + d.key_count, [](uint8_t span) { return span <= RT_SPAN_CUBIC; }),
               "channel: a span is no RT_SPAN_ value");
        append(motion.key_spans, d.spans, d.key_count);
    } else {
        motion.key_spans.resize(motion.key_times.size(), RT_SPAN_LINEAR);
    }
    c.has_handles = d.handles ? 1 : 0;
    c.first_handle = d.handles ? append(motion.key_handles, d.handles, 4 * values) : 0;
    content_.channels.push_back(c);
}

rt_u32 MotionSink::morph(const rt_morph_desc& d, std::string name, const std::vector<rt_u32>& meshes) {
    Morph morph;
    morph.name = std::move(name);
    morph.mesh = mesh_of(d.mesh, meshes, "morph");
    morph.weight = are_usable(&d.weight, 1) ? d.weight : 0;
    demand(d.target_count == 0 || d.targets, "morph '" + morph.name + "': it has targets, but no array of them");
    Motion& motion = scene_.motion;
    morph.first_target = static_cast<rt_u32>(motion.morph_targets.size());
    const rt_u32 vertex_count = scene_.meshes[morph.mesh].vertex_count;
    for (rt_u32 i = 0; i < d.target_count; ++i) {
        const rt_morph_target& from = d.targets[i];
        demand(from.count == 0 || from.positions, "morph '" + morph.name + "': a target has no positions");
        const auto outside = [&](rt_u32 v) { return v >= vertex_count; };
        const bool good = are_usable(&from.weight, 1) && from.weight != 0 && from.count <= vertex_count &&
                          are_usable(from.positions, 3 * from.count) &&
                          (!from.normals || are_usable(from.normals, 3 * from.count)) &&
                          !(from.vertices && std::any_of(from.vertices, from.vertices + from.count, outside));
        if (!good) {
            ++lost_morphs_;
            continue;
        }
        MorphTarget target;
        target.weight = from.weight;
        target.count = from.count;
        target.first = motion.morph_vertices.size();
        std::vector<rt_u32>& vertices = motion.morph_vertices.own();
        for (uint64_t k = 0; k < from.count; ++k) vertices.push_back(from.vertices ? from.vertices[k] : static_cast<rt_u32>(k));
        append(motion.morph_positions, from.positions, 3 * from.count);
        target.has_normals = from.normals ? 1 : 0;
        if (from.normals) target.first_normal = append(motion.morph_normals, from.normals, 3 * from.count);
        motion.morph_targets.push_back(target);
        ++morph.target_count;
    }
    content_.deforms = true;
    morphs_.push_back(static_cast<rt_u32>(motion.morphs.size()));
    motion.morphs.push_back(std::move(morph));
    return static_cast<rt_u32>(morphs_.size());
}

void MotionSink::skin(const rt_skin_desc& d, const std::vector<rt_u32>& meshes) {
    Skin skin;
    skin.mesh = mesh_of(d.mesh, meshes, "skin");
    skin.method = d.method;
    skin.root = RT_NONE;
    demand(d.method <= RT_SKIN_BLENDED, "skin: method " + std::to_string(d.method) + " is unknown");
    demand((d.bone_count == 0 || d.bones) && (d.weight_count == 0 || d.weights),
           "skin: it has bones or weights, but no array of them");
    demand(d.method != RT_SKIN_BLENDED || d.dual_quaternion_shares, "skin: RT_SKIN_BLENDED needs dual_quaternion_shares");
    for (const Skin& other : content_.skins) demand(other.mesh != skin.mesh, "skin: the mesh has one already");
    skin.first_bone = static_cast<rt_u32>(content_.bones.size());
    skin.bone_count = d.bone_count;
    for (rt_u32 b = 0; b < d.bone_count; ++b) {
        Bone bone;
        bone.node = node_of(d.bones[b].node, "bone");
        demand(bone.node != RT_NONE, "skin: bone " + std::to_string(b) + " has no node");
        std::copy_n(d.bones[b].bone_from_mesh, 12, bone.bone_from_mesh);
        if (!are_usable(bone.bone_from_mesh, 12)) {
            std::copy(kIdentityMatrix.begin(), kIdentityMatrix.end(), bone.bone_from_mesh);
            ++lost_weights_;
        }
        content_.bones.push_back(bone);
    }
    Motion& motion = scene_.motion;
    const rt_u32 vertex_count = scene_.meshes[skin.mesh].vertex_count;
    std::vector<rt_weight>& weights = motion.weights.own();
    skin.first_weight = weights.size();
    for (uint64_t i = 0; i < d.weight_count; ++i) {
        const rt_weight& w = d.weights[i];
        demand(w.bone < d.bone_count,
               "skin: bone " + std::to_string(w.bone) + " of " + std::to_string(d.bone_count) + " in a weight");
        if (w.vertex < vertex_count && is_usable(w.weight) && w.weight >= 0) {
            if (w.weight > 0) weights.push_back(w);
        } else {
            ++lost_weights_;
        }
    }
    const auto first = weights.begin() + static_cast<std::ptrdiff_t>(skin.first_weight);
    std::stable_sort(first, weights.end(), [](const rt_weight& a, const rt_weight& b) { return a.vertex < b.vertex; });
    skin.weight_count = weights.size() - skin.first_weight;
    if (d.method == RT_SKIN_BLENDED) {
        skin.has_shares = 1;
        skin.first_share = motion.shares.size();
        for (rt_u32 v = 0; v < vertex_count; ++v) {
            const float share = d.dual_quaternion_shares[v];
            motion.shares.push_back(share > 0 ? std::min(share, 1.f) : 0);  // also for what is no number
        }
    }
    content_.skins.push_back(skin);
}

void MotionSink::vertex_frames(const rt_vertex_frames& d, const std::vector<rt_u32>& meshes) {
    VertexFrames frames;
    frames.mesh = mesh_of(d.mesh, meshes, "vertex frames");
    demand(d.frame_count > 0 && d.times_s && d.positions, "vertex frames: there are none");
    const uint64_t numbers = 3 * d.frame_count * scene_.meshes[frames.mesh].vertex_count;
    Motion& motion = scene_.motion;
    for (const VertexFrames& other : motion.frames)
        demand(other.mesh != frames.mesh, "vertex frames: the mesh has some already");
    if (!in_order(d.times_s, d.frame_count) || !are_usable(d.positions, numbers)) {
        ++lost_frames_;
        return;
    }
    frames.frame_count = d.frame_count;
    frames.first_time = append(motion.frame_times, d.times_s, d.frame_count);
    frames.first_position = append(motion.frame_positions, d.positions, numbers);
    motion.frames.push_back(frames);
    content_.deforms = true;
}

std::vector<std::string> MotionSink::losses() const {
    std::vector<std::string> texts;
    const auto add = [&](uint64_t count, const char* what) {
        if (count > 0) texts.push_back(std::to_string(count) + what);
    };
    add(lost_nodes_, " nodes have transforms that are not finite numbers; they do not move anything");
    add(lost_channels_, " channels of keys are left out: their times are not in order, or a number is not finite");
    add(lost_weights_, " weights or bones of skins are left out: they name no vertex, or a number is not finite or negative");
    add(lost_morphs_, " targets of morphs are left out: they name no vertex, or a number is not finite");
    add(lost_frames_, " geometry caches are left out: their times are not in order, or a number is not finite");
    return texts;
}

}  // namespace clarity::import
