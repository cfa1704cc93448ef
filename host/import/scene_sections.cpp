#include "import/scene_sections.hpp"

#include <string>
#include <utility>

namespace clarity::import {

Converted convert(const Scene& s) {
    Converted c;
    const auto name = [&](const std::string& text) {
        c.names.insert(c.names.end(), text.begin(), text.end());
        return static_cast<uint32_t>(text.size());
    };
    c.globals.push_back({s.background, s.ambient, s.up_axis, 0, s.unit_scale, s.origin, s.sky.values, name(s.sky.file)});
    for (const Mesh& m : s.meshes) {
        c.meshes.push_back({name(m.name), m.first_vertex, m.vertex_count, m.first_triangle, m.triangle_count, m.polygon_count});
    }
    for (const Instance& i : s.instances)
        c.instances.push_back({name(i.name), i.mesh, i.material, i.visible, i.node, i.root, i.moving_mesh, i.world_from_object,
                               i.node_from_object});
    for (const ShapeKind& kind : s.shape_kinds) c.shape_kinds.push_back(name(kind.id));
    for (const Material& m : s.materials) c.materials.push_back({name(m.name), m.values, m.maps});
    for (const Light& l : s.lights) c.lights.push_back({name(l.name), l.node, l.values, l.at_node});
    for (const Camera& k : s.cameras)
        c.cameras.push_back({name(k.name), k.node, k.eye, k.target, k.up, k.node_eye, k.node_target, k.node_up, k.fov_y_rad,
                             k.aperture, k.focus});
    for (const Node& n : s.motion.nodes) c.nodes.push_back({name(n.name), 0, n.values});
    for (const Clip& k : s.motion.clips)
        c.clips.push_back({name(k.name), k.rig, k.first_layer, k.layer_count, k.begin_s, k.end_s, k.fps});
    for (const Morph& m : s.motion.morphs) c.morphs.push_back({name(m.name), m.mesh, m.first_target, m.target_count, m.weight});
    for (const FileSequence& q : s.motion.sequences)
        c.sequences.push_back({name(q.pattern), q.first_mesh, q.mesh_count, q.first_number, q.number_count, 0, q.fps});
    for (const std::string& warning : s.warnings) c.warnings.push_back(name(warning));
    for (const SceneEdit& edit : s.edits)
        for (const std::string* text : {&edit.key, &edit.value, &edit.where}) c.edits.push_back(name(*text));
    for (const std::string& source : s.sources) c.sources.push_back(name(source));
    for (const std::string& text : s.texture_names) c.texture_names.push_back(name(text));
    return c;
}

bool convert_back(const Converted& c, Scene& s) {
    size_t at = 0;
    bool good = c.globals.size() == 1;
    const auto name = [&](uint32_t bytes) {
        good = good && bytes <= c.names.size() - at;
        if (!good) return std::string();
        at += bytes;
        return std::string(c.names.data() + at - bytes, bytes);
    };
    if (!good) return false;
    const WireGlobals& g = c.globals.front();
    s.background = g.background;
    s.ambient = g.ambient;
    s.up_axis = g.up_axis;
    s.unit_scale = g.unit_scale;
    s.origin = g.origin;
    s.sky.values = g.sky;
    s.sky.file = name(g.sky_file_bytes);
    for (const WireMesh& m : c.meshes) {
        s.meshes.push_back(
            {name(m.name_bytes), m.first_vertex, m.vertex_count, m.first_triangle, m.triangle_count, m.polygon_count});
    }
    for (const WireInstance& i : c.instances)
        s.instances.push_back({name(i.name_bytes), i.mesh, i.material, i.world_from_object, i.visible != 0, i.node, i.root,
                               i.moving_mesh, i.node_from_object});
    for (const uint32_t bytes : c.shape_kinds) s.shape_kinds.push_back({name(bytes), nullptr});
    for (const WireMaterial& m : c.materials) s.materials.push_back({name(m.name_bytes), m.values, m.maps});
    for (const WireLight& l : c.lights) s.lights.push_back({name(l.name_bytes), l.values, l.node, l.at_node, 0});
    for (const WireCamera& k : c.cameras)
        s.cameras.push_back({name(k.name_bytes), k.eye, k.target, k.up, k.fov_y_rad, k.aperture, k.focus, k.node, k.node_eye,
                             k.node_target, k.node_up, 0});
    for (const WireNode& n : c.nodes) {
        s.motion.nodes.push_back({name(n.name_bytes), n.values});
        s.motion.nodes.back().values.name = nullptr;
    }
    for (const WireClip& k : c.clips)
        s.motion.clips.push_back({name(k.name_bytes), k.rig, k.first_layer, k.layer_count, k.begin_s, k.end_s, k.fps});
    for (const WireMorph& m : c.morphs)
        s.motion.morphs.push_back({name(m.name_bytes), m.mesh, m.first_target, m.target_count, m.weight});
    for (const WireSequence& q : c.sequences)
        s.motion.sequences.push_back({name(q.name_bytes), q.first_mesh, q.mesh_count, q.first_number, q.number_count, q.fps});
    for (const uint32_t bytes : c.warnings) s.warnings.push_back(name(bytes));
    good = good && c.edits.size() % 3 == 0;
    for (size_t i = 0; good && i < c.edits.size(); i += 3) {
        SceneEdit edit;
        edit.key = name(c.edits[i]);
        edit.value = name(c.edits[i + 1]);
        edit.where = name(c.edits[i + 2]);
        s.edits.push_back(std::move(edit));
    }
    for (const uint32_t bytes : c.sources) s.sources.push_back(name(bytes));
    for (const uint32_t bytes : c.texture_names) s.texture_names.push_back(name(bytes));
    return good && at == c.names.size();
}

}  // namespace clarity::import
