// motion.hpp -- what moves in a scene, as the files have it: nodes, clips of keyed channels, skins, morphs and vertex frames.
// rt_plugin.h says what each means. Arrays are flat, so that they pass through shared memory as they are.
#pragma once
#include <string>
#include <vector>

#include "base/members.hpp"
#include "rt_plugin.h"
#include "scene/shared_array.hpp"

namespace clarity {

struct Node {
    std::string name;
    // parent: index of an earlier node, or RT_NONE. Matrices are filled in. name and struct_bytes are unused.
    rt_node_desc values{};
    template <class Parcel, class Self>
    static void visit(Parcel& parcel, Self& self) {
        parcel(self.name, self.values);
        if constexpr (!Parcel::kWrites) self.values.name = nullptr;
    }
};
static_assert(has_member_count<Node, 2>, "visit() has all of them");

struct Clip {
    std::string name;
    rt_u32 rig = 0;  // the placed file that it moves
    rt_u32 first_layer = 0, layer_count = 0;
    double begin_s = 0, end_s = 0, fps = 0;
    CLARITY_MEMBERS(name, rig, first_layer, layer_count, begin_s, end_s, fps);
};

// Keys of one component or of a quaternion: ranges of the arrays of Motion.
struct Channel {
    rt_u32 clip = 0, layer = 0;  // layer: number within the clip
    rt_u32 moves = 0, target = 0, component = 0;
    rt_u32 before = 0, after = 0, before_count = 0, after_count = 0;
    rt_u32 has_handles = 0;
    uint64_t first_key = 0, key_count = 0;
    uint64_t first_value = 0;   // in key_values; key_count, or four times as many
    uint64_t first_handle = 0;  // in key_handles; four for each value
    rt_u32 width() const { return component == RT_ALL_COMPONENTS ? 4 : 1; }
};

struct Bone {
    rt_u32 node = 0, pad = 0;
    double bone_from_mesh[12] = {};
};
struct Skin {
    rt_u32 mesh = 0, method = 0;
    rt_u32 root = 0;  // node of the file's placement; deformed vertices are in its space
    rt_u32 first_bone = 0, bone_count = 0, has_shares = 0;
    uint64_t first_weight = 0, weight_count = 0;  // in `weights`, in the order of vertices
    uint64_t first_share = 0;                     // in `shares`, one for each vertex
};

struct Morph {
    std::string name;
    rt_u32 mesh = 0;
    rt_u32 first_target = 0, target_count = 0;
    double weight = 0;  // at rest
    CLARITY_MEMBERS(name, mesh, first_target, target_count, weight);
};
struct MorphTarget {
    double weight = 1;
    uint64_t first = 0, count = 0;  // in morph_vertices, and three times in morph_positions
    uint64_t first_normal = 0;      // in morph_normals
    rt_u32 has_normals = 0, pad = 0;
};

struct VertexFrames {
    rt_u32 mesh = 0, pad = 0;
    uint64_t first_time = 0, frame_count = 0;  // in frame_times
    uint64_t first_position = 0;               // in frame_positions: 3 for each vertex of each frame
};

// The vertices of a mesh as its file has them, where the scene at rest has those that skin and morphs make of them.
struct StoredMesh {
    rt_u32 mesh = 0, pad = 0;
    uint64_t first = 0;  // three times in stored_positions, and in stored_normals if the scene has normals
};

// Numbered files, each with all vertices of the same meshes at another time. They are read when a pose needs them.
struct FileSequence {
    std::string pattern;  // absolute, with a run of #: see base/files/frame_path.hpp
    rt_u32 first_mesh = 0, mesh_count = 0;
    rt_u32 first_number = 0, number_count = 0;  // in sequence_numbers
    double fps = 24;                            // file n is at n / fps
    CLARITY_MEMBERS(pattern, first_mesh, mesh_count, first_number, number_count, fps);
};

struct Motion {
    std::vector<Node> nodes;  // parents before their children
    std::vector<Clip> clips;  // of each rig in the order of its file
    std::vector<rt_layer> layers;
    std::vector<Channel> channels;  // ordered by clip, layer, what they move, target and component
    SharedArray<double> key_times, key_values, key_handles;
    SharedArray<uint8_t> key_spans;  // one for each key
    std::vector<Skin> skins;         // of each mesh one at most
    std::vector<Bone> bones;
    SharedArray<rt_weight> weights;
    SharedArray<float> shares;
    std::vector<Morph> morphs;
    std::vector<MorphTarget> morph_targets;
    SharedArray<rt_u32> morph_vertices;  // within the mesh
    SharedArray<float> morph_positions, morph_normals;
    std::vector<VertexFrames> frames;  // of each mesh one at most
    SharedArray<double> frame_times;
    SharedArray<float> frame_positions;
    std::vector<StoredMesh> stored;  // ascending by mesh
    SharedArray<float> stored_positions, stored_normals;
    std::vector<FileSequence> sequences;
    std::vector<rt_u32> sequence_numbers;

    bool empty() const { return nodes.empty() && morphs.empty() && frames.empty() && sequences.empty(); }
    CLARITY_MEMBERS(nodes, clips, layers, channels, key_times, key_values, key_handles, key_spans, skins, bones, weights,
                    shares, morphs, morph_targets, morph_vertices, morph_positions, morph_normals, frames, frame_times,
                    frame_positions, stored, stored_positions, stored_normals, sequences, sequence_numbers);
};

}  // namespace clarity
