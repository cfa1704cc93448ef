#include "import/scene_sections.hpp"

#include <string>
#include <tuple>
#include <utility>

namespace clarity::import {

namespace {

// The members that the struct of a section has in common with that of the scene. Their names are apart.
constexpr auto kMesh = [](auto& m) {
    return std::tie(m.first_vertex, m.vertex_count, m.first_triangle, m.triangle_count, m.polygon_count);
};
constexpr auto kInstance = [](auto& i) {
    return std::tie(i.mesh, i.material, i.visible, i.node, i.root, i.moving_mesh, i.world_from_object, i.node_from_object);
};
constexpr auto kMaterial = [](auto& m) { return std::tie(m.values, m.maps); };
constexpr auto kLight = [](auto& l) { return std::tie(l.values, l.node, l.at_node); };
constexpr auto kCamera = [](auto& k) {
    return std::tie(k.eye, k.target, k.up, k.fov_y_rad, k.aperture, k.focus, k.node, k.node_eye, k.node_target, k.node_up);
};
constexpr auto kNode = [](auto& n) { return std::tie(n.values); };
constexpr auto kClip = [](auto& k) { return std::tie(k.rig, k.first_layer, k.layer_count, k.begin_s, k.end_s, k.fps); };
constexpr auto kMorph = [](auto& m) { return std::tie(m.mesh, m.first_target, m.target_count, m.weight); };
constexpr auto kSequence = [](auto& q) { return std::tie(q.first_mesh, q.mesh_count, q.first_number, q.number_count, q.fps); };

}  // namespace

Converted convert(const Scene& s) {
    Converted c;
    const auto name = [&](const std::string& text) {
        c.names.insert(c.names.end(), text.begin(), text.end());
        return static_cast<uint32_t>(text.size());
    };
    c.globals.push_back({s.background, s.ambient, s.up_axis, 0, s.unit_scale, s.origin, s.sky.values, name(s.sky.file)});
    const auto add = [&](auto& section, const auto& from, auto text, const auto& members) {
        for (const auto& of : from) {
            auto& to = section.emplace_back();
            to.name_bytes = name(of.*text);
            members(to) = members(of);
        }
    };
    add(c.meshes, s.meshes, &Mesh::name, kMesh);
    add(c.instances, s.instances, &Instance::name, kInstance);
    for (const ShapeKind& kind : s.shape_kinds) c.shape_kinds.push_back(name(kind.id));
    add(c.materials, s.materials, &Material::name, kMaterial);
    add(c.lights, s.lights, &Light::name, kLight);
    add(c.cameras, s.cameras, &Camera::name, kCamera);
    add(c.nodes, s.motion.nodes, &Node::name, kNode);
    add(c.clips, s.motion.clips, &Clip::name, kClip);
    add(c.morphs, s.motion.morphs, &Morph::name, kMorph);
    add(c.sequences, s.motion.sequences, &FileSequence::pattern, kSequence);
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
    const auto add = [&](auto& to, const auto& section, auto text, const auto& members) {
        for (const auto& from : section) {
            auto& of = to.emplace_back();
            of.*text = name(from.name_bytes);
            members(of) = members(from);
        }
    };
    add(s.meshes, c.meshes, &Mesh::name, kMesh);
    add(s.instances, c.instances, &Instance::name, kInstance);
    for (const uint32_t bytes : c.shape_kinds) s.shape_kinds.push_back({name(bytes), nullptr});
    add(s.materials, c.materials, &Material::name, kMaterial);
    add(s.lights, c.lights, &Light::name, kLight);
    add(s.cameras, c.cameras, &Camera::name, kCamera);
    add(s.motion.nodes, c.nodes, &Node::name, kNode);
    for (Node& node : s.motion.nodes) node.values.name = nullptr;
    add(s.motion.clips, c.clips, &Clip::name, kClip);
    add(s.motion.morphs, c.morphs, &Morph::name, kMorph);
    add(s.motion.sequences, c.sequences, &FileSequence::pattern, kSequence);
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
