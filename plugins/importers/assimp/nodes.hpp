// nodes.hpp -- computes the world transforms of the nodes of an imported scene.
#pragma once
#include <assimp/scene.h>

#include <array>
#include <string>
#include <unordered_map>
#include <vector>

#include "../common/matrix.hpp"

namespace assimp_import {

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
