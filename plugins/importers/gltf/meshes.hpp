// meshes.hpp -- joins the primitives of a mesh to one mesh of the host, which nodes with the same mesh share.
#pragma once
#include <map>
#include <memory>
#include <set>
#include <tuple>
#include <vector>

#include "accessors.hpp"
#include "compressed.hpp"
#include "materials.hpp"
#include "nodes.hpp"
#include "rt_plugin.h"

namespace gltf_import {

// Vertices of one or more primitives with the same attributes, within the host's mesh.
struct Part {
    Value primitive;
    rt_u32 first;
    uint64_t count;
    TextureSets sets;                        // of texture coordinates, which are the host's
    std::shared_ptr<const DracoMesh> draco;  // its data, if Draco has compressed it
};

class Meshes {
 public:
    // animated: the nodes that have weights of morphs which an animation changes.
    Meshes(const Document& document, Accessors& accessors, Materials& materials, const NodeTree& tree,
           const rt_scene_sink& sink, std::set<size_t> animated);

    // Adds an instance of the node's mesh, if it has one.
    void place(size_t node);
    // The ids of the morphs of the node's mesh, one for each of the file's morph targets.
    const std::vector<rt_u32>& morphs(size_t node) const;
    // Warns about everything that was left out.
    void report() const;

 private:
    struct Geometry;
    struct Built {
        rt_u32 mesh = RT_NONE;  // RT_NONE: there are no triangles
        std::vector<rt_u32> morphs;
    };
    Built build(const Value& mesh, const Value& node, const std::string& name);
    void add_primitive(const Value& primitive, Geometry& geometry);
    const Part& add_vertices(const Value& primitive, Geometry& geometry);
    void add_faces(const Value& primitive, const Part& part, Geometry& geometry);
    std::shared_ptr<const DracoMesh> draco_of(const Value& primitive);
    // An attribute's values, as Accessors has them, or from what Draco has compressed.
    Elements<float> floats(const Part& part, const std::string& attribute, std::string_view types, uint64_t count);
    Elements<uint32_t> integers(const Part& part, const std::string& attribute, std::string_view types, uint64_t count);
    void add_skin(const Value& skin, rt_u32 mesh, const std::vector<Part>& parts);
    std::vector<rt_u32> add_morphs(const Value& mesh, const Value& node, rt_u32 id, const std::vector<Part>& parts);

    Accessors& accessors_;
    Materials& materials_;
    const NodeTree& tree_;
    const rt_scene_sink& sink_;
    const Value meshes_, skins_;
    const std::set<size_t> animated_;
    // By mesh, skin, and node if its weights are its own; size_t(-1): none.
    std::map<std::tuple<size_t, size_t, size_t>, Built> built_;
    std::map<size_t, const Built*> of_node_;
    uint64_t points_and_lines_ = 0, triangles_ = 0, unweighted_ = 0;
    bool copies_left_out_ = false;
};

}  // namespace gltf_import
