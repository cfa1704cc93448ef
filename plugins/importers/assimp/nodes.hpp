// nodes.hpp -- where the nodes of an imported scene stand in the world.
#pragma once
#include <assimp/scene.h>

#include <array>
#include <string>
#include <unordered_map>
#include <vector>

namespace assimp_import {

// Row-major 3x4, in double: chains of many small rotations stay exact to float.
using Transform = std::array<double, 12>;
Transform multiply(const Transform& a, const Transform& b);  // a after b
std::array<double, 3> transform_point(const Transform& m, const aiVector3D& p);
std::array<double, 3> transform_vector(const Transform& m, const aiVector3D& v);
bool is_finite(const Transform& m);

struct PlacedNode {
    const aiNode* node = nullptr;
    Transform world{};           // what children, lights and cameras inherit
    Transform world_geometry{};  // of the node's own meshes
};

// All nodes of the tree, parents first, without recursion (files may nest as deep as they like).
//
// FBX: with preserved pivots assimp gives one node per part of a node's transform, named `<node>_$AssimpFbx$_<part>`. Geometric
// transforms belong to a node's meshes only. assimp 5.2 undoes them for the children by further nodes, but in an order that is
// wrong for a rotation with a scaling; here they are kept out of what is inherited, and the undoing nodes are skipped.
class NodeTree {
 public:
    NodeTree(const aiScene& scene, bool is_fbx);
    const std::vector<PlacedNode>& nodes() const { return nodes_; }
    // The n-th node of a name in file order, for lights and cameras, which refer to nodes by name only (and FBX names need not
    // be unique). The last one if there are fewer; nullptr if there is none.
    const PlacedNode* find(const std::string& name, size_t n) const;

 private:
    std::vector<PlacedNode> nodes_;
    std::unordered_map<std::string, std::vector<size_t>> by_name_;
};

}  // namespace assimp_import
