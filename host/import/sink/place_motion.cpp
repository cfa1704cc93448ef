#include <algorithm>

#include "import/sink/file_content.hpp"
#include "scene/motion/matrix.hpp"

namespace clarity::import {
namespace {

// A node that stands for the placement of a file.
Node placement_node(const Placement& placement) {
    Node node;
    node.name = placement.name;
    rt_node_desc& values = node.values;
    values.parent = placement.node;
    values.rotation_order = RT_ROTATE_QUATERNION;
    values.rotation[3] = 1;
    const Matrix placed = to_matrix(placement.node == RT_NONE ? placement.world_from_object : placement.node_from_object);
    for (int i = 0; i < 3; ++i) values.scale[i] = 1;
    std::copy(placed.begin(), placed.end(), values.before_rotation);
    std::copy(kIdentityMatrix.begin(), kIdentityMatrix.end(), values.after_rotation);
    std::copy(kIdentityMatrix.begin(), kIdentityMatrix.end(), values.after_scale);
    return node;
}

template <class T>
rt_u32 size_of(const std::vector<T>& values) {
    return static_cast<rt_u32>(values.size());
}

}  // namespace

rt_u32 place_motion(const FileContent& content, const Placement& placement, FileContent& into) {
    if (!content.moves() && placement.node == RT_NONE) return RT_NONE;
    const rt_u32 root = size_of(into.nodes), first_node = root + 1, first_clip = size_of(into.clips);
    const rt_u32 first_layer = size_of(into.layers);
    into.nodes.push_back(placement_node(placement));
    for (Node node : content.nodes) {
        rt_u32& parent = node.values.parent;
        parent = parent == RT_NONE ? root : parent + first_node;
        into.nodes.push_back(std::move(node));
    }
    for (Clip clip : content.clips) {
        clip.rig += into.rig_count;
        clip.first_layer += first_layer;
        into.clips.push_back(std::move(clip));
    }
    into.rig_count += content.rig_count;
    into.layers.insert(into.layers.end(), content.layers.begin(), content.layers.end());
    for (Channel channel : content.channels) {
        channel.clip += first_clip;
        if (channel.moves <= RT_MOVES_VISIBILITY) channel.target += first_node;
        into.channels.push_back(channel);
    }
    for (Skin skin : content.skins) {
        // A mesh deforms once, in its file's space, wherever the file is placed.
        const auto same = [&](const Skin& other) { return other.mesh == skin.mesh; };
        if (std::any_of(into.skins.begin(), into.skins.end(), same)) continue;
        const rt_u32 first_bone = size_of(into.bones);
        for (rt_u32 b = 0; b < skin.bone_count; ++b) {
            into.bones.push_back(content.bones[skin.first_bone + b]);
            into.bones.back().node += first_node;
        }
        skin.first_bone = first_bone;
        skin.root = skin.root == RT_NONE ? root : skin.root + first_node;
        into.skins.push_back(skin);
    }
    into.deforms = into.deforms || content.deforms;
    return root;
}

}  // namespace clarity::import
