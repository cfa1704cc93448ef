// validate_motion.cpp -- whether the motion of a scene is sound: all ranges lie within their arrays, all indices exist, and all
// numbers are finite. A scene comes from a worker that runs code of strangers.
#include <algorithm>
#include <cmath>

#include "base/problem.hpp"
#include "scene/light_kinds.hpp"
#include "scene/scene.hpp"

namespace clarity {
namespace {

template <class T>
bool all_finite(const SharedArray<T>& values) {
    return std::all_of(values.begin(), values.end(), [](T x) { return std::isfinite(x); });
}
template <class Range>
bool all_finite_in(const Range& values) {
    return std::all_of(std::begin(values), std::end(values), [](double x) { return std::isfinite(x); });
}
bool within(uint64_t first, uint64_t count, size_t size) {
    return first <= size && count <= size - first;
}
std::string text(const char* what, size_t index, const char* why) {
    return std::string(what) + " " + std::to_string(index) + ": " + why;
}

Problem check_nodes(const Motion& m) {
    for (size_t i = 0; i < m.nodes.size(); ++i) {
        const rt_node_desc& n = m.nodes[i].values;
        if (n.parent != RT_NONE && n.parent >= i) return text("node", i, "its parent does not come before it");
        if (n.rotation_order > RT_ROTATE_QUATERNION || n.inherit > RT_INHERIT_RRS) return text("node", i, "unknown order");
        if (!all_finite_in(n.translation) || !all_finite_in(n.rotation) || !all_finite_in(n.scale) ||
            !all_finite_in(n.before_rotation) || !all_finite_in(n.after_rotation) || !all_finite_in(n.after_scale))
            return text("node", i, "not a finite number");
    }
    return {};
}

Problem check_channels(const Scene& s) {
    const Motion& m = s.motion;
    if (m.key_spans.size() != m.key_times.size()) return "keys: not one span for each";
    if (!all_finite(m.key_times) || !all_finite(m.key_values) || !all_finite(m.key_handles)) return "keys: not a finite number";
    for (size_t i = 0; i < m.clips.size(); ++i) {
        const Clip& c = m.clips[i];
        if (!within(c.first_layer, c.layer_count, m.layers.size())) return text("clip", i, "layers past the last one");
        const double numbers[] = {c.begin_s, c.end_s, c.fps};
        if (!all_finite_in(numbers)) return text("clip", i, "not a finite number");
    }
    for (size_t i = 0; i < m.channels.size(); ++i) {
        const Channel& c = m.channels[i];
        if (c.clip >= m.clips.size() || c.layer >= m.clips[c.clip].layer_count) return text("channel", i, "no such layer");
        if (c.key_count == 0 || c.component > RT_ALL_COMPONENTS) return text("channel", i, "no keys, or no such component");
        if (c.key_count > m.key_values.size()) return text("channel", i, "keys past the last one");
        const uint64_t values = c.key_count * c.width();
        if (!within(c.first_key, c.key_count, m.key_times.size()) || !within(c.first_value, values, m.key_values.size()) ||
            (c.has_handles && !within(c.first_handle, 4 * values, m.key_handles.size())))
            return text("channel", i, "keys past the last one");
        const auto times = m.key_times.begin() + static_cast<std::ptrdiff_t>(c.first_key);
        if (!std::is_sorted(times, times + static_cast<std::ptrdiff_t>(c.key_count)))
            return text("channel", i, "its keys are not in order");
        const size_t targets = c.moves <= RT_MOVES_VISIBILITY ? m.nodes.size()
                               : c.moves == RT_MOVES_MORPH    ? m.morphs.size()
                               : c.moves == RT_MOVES_LAYER    ? m.clips[c.clip].layer_count
                               : c.moves == RT_MOVES_FOV      ? s.cameras.size()
                               : c.moves == RT_MOVES_COLOR    ? s.lights.size()
                                                              : 0;
        if (c.target >= targets) return text("channel", i, "it moves something that does not exist");
        const bool whole = c.component == RT_ALL_COMPONENTS;
        if (whole && c.moves != RT_MOVES_ROTATION) return text("channel", i, "only rotations are keyed as a whole");
    }
    return {};
}

Problem check_skins(const Scene& s) {
    const Motion& m = s.motion;
    for (size_t i = 0; i < m.bones.size(); ++i)
        if (m.bones[i].node >= m.nodes.size() || !all_finite_in(m.bones[i].bone_from_mesh))
            return text("bone", i, "no such node, or not a finite number");
    for (size_t i = 0; i < m.skins.size(); ++i) {
        const Skin& skin = m.skins[i];
        if (skin.mesh >= s.meshes.size()) return text("skin", i, "no such mesh");
        if (skin.root != RT_NONE && skin.root >= m.nodes.size()) return text("skin", i, "no such root");
        if (skin.method > RT_SKIN_BLENDED) return text("skin", i, "unknown method");
        if (!within(skin.first_bone, skin.bone_count, m.bones.size()) ||
            !within(skin.first_weight, skin.weight_count, m.weights.size()))
            return text("skin", i, "bones or weights past the last one");
        const rt_u32 vertex_count = s.meshes[skin.mesh].vertex_count;
        if (skin.method == RT_SKIN_BLENDED && !within(skin.first_share, vertex_count, m.shares.size()))
            return text("skin", i, "shares past the last one");
        for (uint64_t k = skin.first_weight; k < skin.first_weight + skin.weight_count; ++k) {
            const rt_weight& w = m.weights[k];
            if (w.bone >= skin.bone_count || w.vertex >= vertex_count || !std::isfinite(w.weight))
                return text("skin", i, "a weight names no bone or no vertex, or is not finite");
            if (k > skin.first_weight && m.weights[k - 1].vertex > w.vertex) return text("skin", i, "weights are not in order");
        }
    }
    return all_finite(m.shares) ? "" : "shares of skins: not a finite number";
}

Problem check_morphs(const Scene& s) {
    const Motion& m = s.motion;
    if (!all_finite(m.morph_positions) || !all_finite(m.morph_normals)) return "morphs: not a finite number";
    for (size_t i = 0; i < m.morphs.size(); ++i) {
        const Morph& morph = m.morphs[i];
        if (morph.mesh >= s.meshes.size()) return text("morph", i, "no such mesh");
        if (!within(morph.first_target, morph.target_count, m.morph_targets.size()) || !std::isfinite(morph.weight))
            return text("morph", i, "targets past the last one, or a weight that is not finite");
        for (size_t t = morph.first_target; t < size_t(morph.first_target) + morph.target_count; ++t) {
            const MorphTarget& target = m.morph_targets[t];
            if (!std::isfinite(target.weight) || !within(target.first, target.count, m.morph_vertices.size()) ||
                !within(3 * target.first, 3 * target.count, m.morph_positions.size()) ||
                (target.has_normals && !within(target.first_normal, 3 * target.count, m.morph_normals.size())))
                return text("target of a morph", t, "offsets past the last one, or a weight that is not finite");
            const auto vertices = m.morph_vertices.begin() + static_cast<std::ptrdiff_t>(target.first);
            const auto outside = [&](rt_u32 v) { return v >= s.meshes[morph.mesh].vertex_count; };
            if (std::any_of(vertices, vertices + static_cast<std::ptrdiff_t>(target.count), outside))
                return text("target of a morph", t, "it names no vertex");
        }
    }
    return {};
}

Problem check_frames(const Scene& s) {
    const Motion& m = s.motion;
    if (!all_finite(m.frame_times) || !all_finite(m.frame_positions)) return "vertex frames: not a finite number";
    for (size_t i = 0; i < m.frames.size(); ++i) {
        const VertexFrames& f = m.frames[i];
        if (f.mesh >= s.meshes.size()) return text("vertex frames", i, "no such mesh");
        const uint64_t numbers = 3 * uint64_t(s.meshes[f.mesh].vertex_count);
        if (f.frame_count == 0 || !within(f.first_time, f.frame_count, m.frame_times.size()) ||
            f.first_position > m.frame_positions.size() ||
            (numbers > 0 && f.frame_count > (m.frame_positions.size() - f.first_position) / numbers))
            return text("vertex frames", i, "frames past the last one");
        const auto times = m.frame_times.begin() + static_cast<std::ptrdiff_t>(f.first_time);
        if (!std::is_sorted(times, times + static_cast<std::ptrdiff_t>(f.frame_count)))
            return text("vertex frames", i, "frames are not in order");
    }
    return {};
}

Problem check_stored(const Scene& s) {
    const Motion& m = s.motion;
    if (!all_finite(m.stored_positions) || !all_finite(m.stored_normals)) return "stored meshes: not a finite number";
    for (size_t i = 0; i < m.stored.size(); ++i) {
        const StoredMesh& stored = m.stored[i];
        if (stored.mesh >= s.meshes.size() || (i > 0 && m.stored[i - 1].mesh >= stored.mesh))
            return text("stored mesh", i, "no such mesh, or not in order");
        const uint64_t vertex_count = s.meshes[stored.mesh].vertex_count;
        if (!within(stored.first, vertex_count, m.stored_positions.size() / 3) ||
            (!s.normals.empty() && !within(stored.first, vertex_count, m.stored_normals.size() / 3)))
            return text("stored mesh", i, "vertices past the last one");
    }
    return {};
}

Problem check_sequences(const Scene& s) {
    for (size_t i = 0; i < s.motion.sequences.size(); ++i) {
        const FileSequence& q = s.motion.sequences[i];
        if (!within(q.first_mesh, q.mesh_count, s.meshes.size())) return text("sequence", i, "meshes past the last one");
        if (q.number_count == 0 || !within(q.first_number, q.number_count, s.motion.sequence_numbers.size()))
            return text("sequence", i, "files past the last one");
        if (!(q.fps > 0 && q.fps <= 1e6)) return text("sequence", i, "its rate is no positive number");
    }
    return {};
}

Problem check_hung(const Scene& s) {
    const auto bad = [&](rt_u32 node) { return node != RT_NONE && node >= s.motion.nodes.size(); };
    for (size_t i = 0; i < s.instances.size(); ++i) {
        const Instance& instance = s.instances[i];
        if (bad(instance.node) || bad(instance.root)) return text("instance", i, "no such node");
        if (instance.node == RT_NONE) continue;
        if (instance.moving_mesh >= s.meshes.size()) return text("instance", i, "no such mesh");
        if (!all_finite_in(instance.node_from_object)) return text("instance", i, "not a finite number");
    }
    for (size_t i = 0; i < s.cameras.size(); ++i) {
        const Camera& c = s.cameras[i];
        if (bad(c.node)) return text("camera", i, "no such node");
        if (!all_finite_in(c.node_eye) || !all_finite_in(c.node_target) || !all_finite_in(c.node_up))
            return text("camera", i, "not a finite number");
    }
    for (size_t i = 0; i < s.lights.size(); ++i) {
        const Light& light = s.lights[i];
        if (bad(light.node)) return text("light", i, "no such node");
        if (light.node == RT_NONE) continue;
        if (const Problem fault = light_fault(light.at_node))
            return text("light", i, ("in its node's space " + fault.text()).c_str());
    }
    return {};
}

}  // namespace

Problem validate_motion(const Scene& scene) {
    if (Problem why = check_nodes(scene.motion)) return why;
    for (const auto check :
         {check_channels, check_skins, check_morphs, check_frames, check_stored, check_sequences, check_hung})
        if (Problem why = check(scene)) return why;
    return {};
}

}  // namespace clarity
