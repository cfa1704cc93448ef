// scene_sections.hpp -- a Scene as a list of plain arrays: what passes through shared memory, and what a digest is made of.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace clarity::import {

struct WireGlobals {
    std::array<float, 3> background, ambient;
    uint32_t up_axis, pad;
    double unit_scale;
    std::array<double, 3> origin;
    SkyValues sky;
    uint32_t sky_file_bytes;
};
struct WireMesh {
    uint32_t name_bytes, first_vertex, vertex_count, first_triangle, triangle_count, polygon_count;
};
struct WireInstance {
    uint32_t name_bytes, mesh, material, visible, node, root, moving_mesh;
    Affine world_from_object, node_from_object;
};
struct WireMaterial {
    uint32_t name_bytes;
    MaterialValues values;
    MaterialMaps maps;
};
struct WireLight {
    uint32_t name_bytes, node;
    rt_light values, at_node;
};
struct WireCamera {
    uint32_t name_bytes, node;
    std::array<float, 3> eye, target, up, node_eye, node_target, node_up;
    float fov_y_rad, aperture, focus;
};
struct WireNode {
    uint32_t name_bytes, pad;
    rt_node_desc values;  // its name is NULL
};
struct WireClip {
    uint32_t name_bytes, rig, first_layer, layer_count;
    double begin_s, end_s, fps;
};
struct WireSequence {
    uint32_t name_bytes, first_mesh, mesh_count, first_number, number_count, pad;
    double fps;
};
struct WireMorph {
    uint32_t name_bytes, mesh, first_target, target_count;
    double weight;
};

// The members of Scene which are not plain arrays, converted to plain arrays. None of the structs above has padding.
struct Converted {
    std::vector<WireGlobals> globals;
    std::vector<WireMesh> meshes;
    std::vector<WireInstance> instances;
    std::vector<WireMaterial> materials;
    std::vector<WireLight> lights;
    std::vector<WireCamera> cameras;
    std::vector<WireNode> nodes;
    std::vector<WireClip> clips;
    std::vector<WireMorph> morphs;
    std::vector<WireSequence> sequences;
    std::vector<uint32_t> shape_kinds, warnings, edits, sources, texture_names;  // length of each text in `names`, in bytes
    std::vector<char> names;
};

// The one list of all sections: whoever writes, reads or compares scenes uses it, so that they always agree.
template <class S, class C, class Visitor>
void visit(S& s, C& c, Visitor&& v) {
    v(c.globals), v(s.positions), v(s.normals), v(s.uvs), v(s.uvs2), v(s.colors), v(s.tangents), v(s.triangles),
        v(s.triangle_materials);
    v(c.meshes), v(c.instances);
    v(s.spheres), v(s.planes), v(s.polygons), v(s.polygon_corners), v(c.shape_kinds), v(s.shapes), v(s.shape_parts);
    v(s.shape_numbers), v(c.materials), v(s.maps), v(s.textures), v(s.texels), v(s.sky.texels), v(c.lights);
    v(c.cameras), v(c.nodes), v(c.clips), v(c.morphs);
    auto& m = s.motion;
    v(m.layers), v(m.channels), v(m.key_times), v(m.key_values), v(m.key_handles), v(m.key_spans), v(m.skins), v(m.bones);
    v(m.weights), v(m.shares), v(m.morph_targets), v(m.morph_vertices), v(m.morph_positions), v(m.morph_normals), v(m.frames);
    v(m.frame_times), v(m.frame_positions), v(m.stored), v(m.stored_positions), v(m.stored_normals), v(m.sequence_numbers),
        v(c.sequences), v(c.warnings), v(c.edits), v(c.sources), v(c.texture_names), v(c.names);
}

// The members of a scene that are no plain arrays.
Converted convert(const Scene& scene);
// Converts back to a Scene. Returns false if the names do not match their lengths.
bool convert_back(const Converted& converted, Scene& scene);

}  // namespace clarity::import
