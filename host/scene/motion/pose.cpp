#include "scene/motion/pose.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/error.hpp"
#include "scene/camera.hpp"
#include "scene/instance_edit.hpp"
#include "scene/light_kinds.hpp"
#include "scene/motion/clip_values.hpp"
#include "scene/motion/deform.hpp"
#include "scene/motion/file_sequence.hpp"
#include "scene/singular_instances.hpp"
#include "scene/usable.hpp"

namespace clarity {
namespace {

std::vector<PlacedNode> place_nodes(const Motion& motion, const std::vector<NodeValues>& values) {
    std::vector<PlacedNode> placed;
    placed.reserve(motion.nodes.size());
    for (size_t i = 0; i < motion.nodes.size(); ++i) {
        const rt_node_desc& node = motion.nodes[i].values;
        placed.push_back(place_node(node, values[i], node.parent == RT_NONE ? nullptr : &placed[node.parent]));
    }
    return placed;
}

// A skin puts vertices into the space of its file, so the node of the instance does not move them a second time.
std::vector<PosedInstance> pose_instances(const Scene& scene, const std::vector<PlacedNode>& nodes) {
    std::map<rt_u32, rt_u32> root_of_skinned;  // by mesh
    for (const Skin& skin : scene.motion.skins) root_of_skinned[skin.mesh] = skin.root;
    std::vector<PosedInstance> instances;
    instances.reserve(scene.instances.size());
    for (const Instance& instance : scene.instances) {
        PosedInstance posed = {instance.mesh, instance.world_from_object, instance.visible};
        if (instance.node != RT_NONE) {
            const PlacedNode& node = nodes[instance.node];
            posed.mesh = instance.moving_mesh;
            posed.visible = node.visible && !instance.hidden;
            const bool skinned = root_of_skinned.count(posed.mesh) != 0;
            const Matrix root = instance.root == RT_NONE ? kIdentityMatrix : nodes[instance.root].world;
            posed.world_from_object = to_affine(skinned ? root : node.world * to_matrix(instance.node_from_object));
            if (instance.shift != InstanceShift())
                posed.world_from_object = shifted(instance.shift, instance.pivot, posed.world_from_object);
        }
        instances.push_back(posed);
    }
    return instances;
}

void pose_cameras(const std::vector<PlacedNode>& nodes, std::vector<Camera>& cameras) {
    for (Camera& camera : cameras) {
        if (camera.node == RT_NONE) continue;
        Camera moved = moved_by(camera, nodes[camera.node].world);
        if (make_sound(moved)) camera = moved;
    }
}

void pose_lights(const std::vector<PlacedNode>& nodes, std::vector<Light>& lights) {
    for (Light& light : lights) {
        if (light.node == RT_NONE) continue;
        rt_light moved = light.at_node;
        std::copy_n(light.values.color, 3, moved.color);  // which a clip may change
        if (move_light(moved, nodes[light.node].world)) light.values = moved;
    }
}

// acts: for each clip, whether it counts.
std::vector<bool> moving_instances(const Scene& scene, const std::vector<bool>& acts) {
    const Motion& motion = scene.motion;
    std::vector<bool> node_moves(motion.nodes.size()), mesh_deforms(scene.meshes.size());
    for (const Channel& channel : motion.channels) {
        const bool of_node = channel.moves == RT_MOVES_TRANSLATION || channel.moves == RT_MOVES_ROTATION ||
                             channel.moves == RT_MOVES_SCALE || channel.moves == RT_MOVES_VISIBILITY;
        if (of_node && acts[channel.clip] && channel.target < node_moves.size()) node_moves[channel.target] = true;
    }
    for (size_t i = 0; i < motion.nodes.size(); ++i)  // parents come first
        if (const rt_u32 parent = motion.nodes[i].values.parent; parent != RT_NONE && node_moves[parent]) node_moves[i] = true;
    for (const Skin& skin : motion.skins) mesh_deforms[skin.mesh] = true;
    for (const Morph& morph : motion.morphs) mesh_deforms[morph.mesh] = true;
    for (const VertexFrames& frames : motion.frames) mesh_deforms[frames.mesh] = true;
    for (const FileSequence& sequence : motion.sequences)
        for (rt_u32 m = 0; m < sequence.mesh_count; ++m) mesh_deforms[sequence.first_mesh + m] = true;
    std::vector<bool> moving;
    for (const Instance& instance : scene.instances)
        moving.push_back(mesh_deforms[instance.mesh] || (instance.node != RT_NONE && node_moves[instance.node]));
    return moving;
}

}  // namespace

std::vector<ClipInfo> clips(const Scene& scene) {
    const Motion& motion = scene.motion;
    std::vector<ClipInfo> infos;
    for (const Clip& clip : motion.clips) {
        const auto known = std::find_if(infos.begin(), infos.end(), [&](const ClipInfo& i) { return i.name == clip.name; });
        if (known == infos.end()) {
            infos.push_back({clip.name, clip.begin_s, clip.end_s, clip.fps});
        } else {
            known->begin_s = std::min(known->begin_s, clip.begin_s);
            known->end_s = std::max(known->end_s, clip.end_s);
            if (known->fps == 0) known->fps = clip.fps;
        }
    }
    for (ClipInfo& info : infos) {
        const std::vector<bool> acts = acting_clips(motion, info.name);
        std::set<rt_u32> nodes, morphs;
        for (const Channel& channel : motion.channels) {
            if (!acts[channel.clip]) continue;
            if (channel.moves <= RT_MOVES_VISIBILITY) nodes.insert(channel.target);
            if (channel.moves == RT_MOVES_MORPH) morphs.insert(channel.target);
        }
        info.nodes = static_cast<rt_u32>(nodes.size());
        info.morphs = static_cast<rt_u32>(morphs.size());
        info.skins = static_cast<rt_u32>(motion.skins.size());
    }
    return infos;
}

const Deformation* left_out(const Pose& pose, rt_u32 mesh) {
    const auto is_mesh = [mesh](const auto& of) { return of.mesh == mesh; };
    if (std::any_of(pose.meshes.begin(), pose.meshes.end(), is_mesh)) return nullptr;
    const auto found = std::find_if(pose.deformations.begin(), pose.deformations.end(), is_mesh);
    return found == pose.deformations.end() ? nullptr : &*found;
}

std::vector<rt_u32> deforming_meshes(const Pose& pose) {
    std::set<rt_u32> meshes;
    for (const PosedMesh& mesh : pose.meshes) meshes.insert(mesh.mesh);
    for (const Deformation& deformation : pose.deformations) meshes.insert(deformation.mesh);
    return {meshes.begin(), meshes.end()};
}

Pose evaluate(const Scene& scene, const std::string& clip, double time_s, const FrameVertices& read) {
    Pose pose = evaluate_without_vertices(scene, clip, time_s, read);
    add_vertices(scene, pose);
    return pose;
}

void add_vertices(const Scene& scene, Pose& pose) {
    const size_t there = pose.meshes.size();
    for (const Deformation& deformation : pose.deformations) {
        const auto is_mesh = [&](const PosedMesh& mesh) { return mesh.mesh == deformation.mesh; };
        if (std::none_of(pose.meshes.begin(), pose.meshes.begin() + static_cast<std::ptrdiff_t>(there), is_mesh))
            pose.meshes.push_back(deformed(scene, deformation));
    }
}

Pose evaluate_without_vertices(const Scene& scene, const std::string& clip, double time_s, const FrameVertices& read) {
    const Motion& motion = scene.motion;
    Pose pose;
    pose.cameras = scene.cameras;
    pose.lights = scene.lights;
    MovingValues values = values_at_rest(scene);
    if (!clip.empty() || !motion.clips.empty()) play(scene, clip, time_s, values);
    Deformers deformers;
    deformers.nodes = place_nodes(motion, values.nodes);
    deformers.morph_weights = std::move(values.morph_weights);
    deformers.time_s = time_s;
    for (size_t i = 0; i < pose.cameras.size(); ++i) pose.cameras[i].fov_y_rad = values.fovs[i];
    for (size_t i = 0; i < pose.lights.size(); ++i) std::copy_n(values.colors[i].begin(), 3, pose.lights[i].values.color);
    pose.instances = pose_instances(scene, deformers.nodes);
    pose_cameras(deformers.nodes, pose.cameras);
    pose_lights(deformers.nodes, pose.lights);
    pose.deformations = deformations(scene, deformers);
    if (read) add_sequences(scene, time_s, read, pose.meshes);
    return pose;
}

size_t deform_at_rest(Scene& scene, const std::vector<bool>& as_stored) {
    Motion& motion = scene.motion;
    MovingValues values = values_at_rest(scene);
    Deformers deformers;
    deformers.nodes = place_nodes(motion, values.nodes);
    deformers.morph_weights = std::move(values.morph_weights);
    size_t unusable = 0;
    std::set<rt_u32> skinned;
    for (Deformation& d : deformations(scene, deformers)) {
        d.frames = RT_NONE;  // caches belong to times
        if (as_stored[d.mesh] || (d.targets.empty() && d.skin == RT_NONE)) continue;
        const PosedMesh mesh = deformed(scene, d);
        if (!are_usable(mesh.positions) || !are_usable(mesh.normals)) {
            ++unusable;
            continue;
        }
        if (d.skin != RT_NONE) skinned.insert(d.mesh);
        const auto first = 3 * static_cast<std::ptrdiff_t>(scene.meshes[d.mesh].first_vertex);
        const auto keep = [&](const std::vector<float>& now, SharedArray<float>& values, SharedArray<float>& stored) {
            if (now.empty()) return;
            const auto begin = values.own().begin() + first;
            stored.append(begin, begin + static_cast<std::ptrdiff_t>(now.size()));
            std::copy(now.begin(), now.end(), begin);
        };
        motion.stored.push_back({d.mesh, 0, motion.stored_positions.size() / 3});
        keep(mesh.positions, scene.positions, motion.stored_positions);
        keep(mesh.normals, scene.normals, motion.stored_normals);
    }
    if (skinned.empty()) return unusable;
    const std::vector<PosedInstance> posed = pose_instances(scene, deformers.nodes);
    for (size_t i = 0; i < posed.size(); ++i)
        if (skinned.count(posed[i].mesh) != 0) scene.instances[i].world_from_object = posed[i].world_from_object;
    return unusable;
}

Pose pose_at_rest(const Scene& scene) {
    Pose pose;
    for (const Instance& instance : scene.instances)
        pose.instances.push_back({instance.mesh, instance.world_from_object, instance.visible});
    pose.cameras = scene.cameras;
    pose.lights = scene.lights;
    return pose;
}

std::vector<bool> moving_instances(const Scene& scene) {
    return moving_instances(scene, std::vector<bool>(scene.motion.clips.size(), true));
}

std::vector<bool> moving_instances(const Scene& scene, const std::string& clip) {
    return moving_instances(scene, scene.motion.clips.empty() ? std::vector<bool>() : acting_clips(scene.motion, clip));
}

Scene posed(Scene scene, const Pose& pose) {
    Scene result = std::move(scene);
    const std::vector<bool> moving = moving_instances(result);
    result.motion = {};
    for (size_t i = 0; i < result.instances.size(); ++i) {
        Instance& instance = result.instances[i];
        instance.mesh = pose.instances[i].mesh;
        instance.world_from_object = pose.instances[i].world_from_object;
        instance.visible = pose.instances[i].visible;
        instance.node = instance.root = RT_NONE;
        instance.apart = instance.apart || moving[i];
    }
    result.cameras = pose.cameras;
    result.lights = pose.lights;
    for (Camera& camera : result.cameras) camera.node = RT_NONE;
    for (Light& light : result.lights) light.node = RT_NONE;
    for (const PosedMesh& mesh : pose.meshes) {
        const auto first = 3 * static_cast<std::ptrdiff_t>(result.meshes[mesh.mesh].first_vertex);
        std::copy(mesh.positions.begin(), mesh.positions.end(), result.positions.own().begin() + first);
        if (!mesh.normals.empty()) std::copy(mesh.normals.begin(), mesh.normals.end(), result.normals.own().begin() + first);
    }
    bake_singular_instances(result);
    return result;
}

}  // namespace clarity
