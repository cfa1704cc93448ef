// meshes.hpp -- joins the meshes of a node to one mesh of the host, which nodes with the same meshes share.
#pragma once
#include <assimp/scene.h>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "../common/matrix.hpp"
#include "materials.hpp"
#include "rt_plugin.h"

namespace assimp_import {

// assimp splits a mesh by material. This class joins the parts again, with one material per face. Corners with equal attributes
// become one vertex.
class MeshTable {
 public:
    MeshTable(const aiScene& scene, MaterialTable& materials, const rt_scene_sink& sink)
        : scene_(scene), materials_(materials), sink_(sink) {}
    // Returns the mesh made of the node's meshes. RT_NONE: the node has no polygons.
    rt_u32 id(const aiNode& node);

    // Numbers of elements that were left out, and of faces that were not.
    uint64_t points_and_lines() const { return points_and_lines_; }
    uint64_t broken_faces() const { return broken_faces_; }
    uint64_t faces() const { return faces_; }
    uint64_t colored() const { return colored_; }  // parts of meshes whose vertices have colours

 private:
    // Index of a mesh of the scene, and of its material.
    using Part = std::pair<unsigned, unsigned>;
    rt_u32 add(const std::vector<Part>& parts, const char* name);

    const aiScene& scene_;
    MaterialTable& materials_;
    const rt_scene_sink& sink_;
    std::map<std::vector<Part>, rt_u32> ids_;
    uint64_t points_and_lines_ = 0, broken_faces_ = 0, faces_ = 0, colored_ = 0;
};

// Computes the world transforms of the nodes of an imported scene.

using importers::is_finite;
using importers::kIdentity;
using importers::multiply;
using importers::Transform;
std::array<double, 3> transform_point(const Transform& m, const aiVector3D& p);
std::array<double, 3> transform_vector(const Transform& m, const aiVector3D& v);

struct PlacedNode {
    const aiNode* node = nullptr;
    Transform world{};
};

// All nodes of the tree, parents first. It is built without recursion, because files may nest without limit.
class NodeTree {
 public:
    explicit NodeTree(const aiScene& scene);
    const std::vector<PlacedNode>& nodes() const { return nodes_; }
    // Returns the n-th node with a name in the order of the file, the last one if there are fewer, or nullptr if there is none.
    // Lights and cameras refer to nodes by name only, and names need not be unique.
    const PlacedNode* find(const std::string& name, size_t n) const;

 private:
    std::vector<PlacedNode> nodes_;
    std::unordered_map<std::string, std::vector<size_t>> by_name_;
};

}  // namespace assimp_import
