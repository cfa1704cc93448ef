#include "scene/motion/deformation.hpp"

#include <algorithm>
#include <map>

namespace clarity {
namespace {

void choose_frames(const Motion& motion, rt_u32 number, double time_s, Deformation& d) {
    const VertexFrames& frames = motion.frames[number];
    const double* times = &motion.frame_times[frames.first_time];
    const auto after = std::upper_bound(times, times + frames.frame_count, time_s);
    const uint64_t next = std::min<uint64_t>(static_cast<uint64_t>(after - times), frames.frame_count - 1);
    const uint64_t last = after == times ? 0 : static_cast<uint64_t>(after - times) - 1;
    const double span = times[next] - times[last];
    d.frames = number;
    d.frame_before = last;
    d.frame_after = next;
    d.frame_share = span > 0 ? (time_s - times[last]) / span : 0;
}

// Offsets are interpolated between targets, of which the mesh at rest is one, of weight 0. Beyond the outer ones they go
// straight on.
void choose_targets(const Motion& motion, const Morph& morph, double weight, Deformation& d) {
    std::vector<std::pair<double, rt_u32>> knots = {{0, RT_NONE}};
    for (rt_u32 t = morph.first_target; t < morph.first_target + morph.target_count; ++t)
        knots.push_back({motion.morph_targets[t].weight, t});
    std::stable_sort(knots.begin(), knots.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    size_t high = 1;
    while (high + 1 < knots.size() && knots[high].first < weight) ++high;
    if (high >= knots.size()) return;
    const auto &below = knots[high - 1], &above = knots[high];
    const double span = above.first - below.first, x = span > 0 ? (weight - below.first) / span : 1;
    if (above.second != RT_NONE && x != 0) d.targets.push_back({above.second, x});
    if (below.second != RT_NONE && x != 1) d.targets.push_back({below.second, 1 - x});
}

// The instance whose node moves the vertices without weights.
const Instance* instance_of(const Scene& scene, rt_u32 mesh) {
    for (const Instance& instance : scene.instances)
        if (instance.node != RT_NONE && instance.moving_mesh == mesh) return &instance;
    return nullptr;
}

void place_bones(const Scene& scene, const std::vector<PlacedNode>& nodes, rt_u32 number, Deformation& d) {
    const Skin& skin = scene.motion.skins[number];
    Matrix root_from_world = kIdentityMatrix;
    if (skin.root != RT_NONE && !invert(nodes[skin.root].world, root_from_world)) return;  // flattened: nothing is seen
    d.skin = number;
    if (const Instance* instance = instance_of(scene, skin.mesh))
        d.unweighted = root_from_world * nodes[instance->node].world * to_matrix(instance->node_from_object);
    d.bones.resize(skin.bone_count);
    for (rt_u32 b = 0; b < skin.bone_count; ++b) {
        const Bone& bone = scene.motion.bones[skin.first_bone + b];
        Matrix bone_from_mesh{};
        std::copy_n(bone.bone_from_mesh, 12, bone_from_mesh.begin());
        d.bones[b] = root_from_world * nodes[bone.node].world * bone_from_mesh;
    }
}

}  // namespace

std::vector<Deformation> deformations(const Scene& scene, const Deformers& deformers) {
    const Motion& motion = scene.motion;
    std::map<rt_u32, Deformation> by_mesh;
    for (rt_u32 i = 0; i < motion.frames.size(); ++i)
        choose_frames(motion, i, deformers.time_s, by_mesh[motion.frames[i].mesh]);
    for (rt_u32 i = 0; i < motion.morphs.size(); ++i)
        choose_targets(motion, motion.morphs[i], deformers.morph_weights[i], by_mesh[motion.morphs[i].mesh]);
    for (rt_u32 i = 0; i < motion.skins.size(); ++i) place_bones(scene, deformers.nodes, i, by_mesh[motion.skins[i].mesh]);
    std::vector<Deformation> all;
    for (auto& [mesh, d] : by_mesh) {
        d.mesh = mesh;
        std::sort(d.targets.begin(), d.targets.end(), [](const auto& a, const auto& b) { return a.target < b.target; });
        all.push_back(std::move(d));
    }
    return all;
}

}  // namespace clarity
