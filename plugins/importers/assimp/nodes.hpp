// nodes.hpp -- computes the world transforms of the nodes of an imported scene.
#pragma once
#include <assimp/scene.h>

#include <array>
#include <string>
#include <unordered_map>
#include <vector>

namespace assimp_import {

// A 3x4 matrix, row-major, in double precision, so that chains of many small rotations stay exact to float precision.
using Transform = std::array<double, 12>;
inline constexpr Transform kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
Transform multiply(const Transform& a, const Transform& b);  // applies b first, then a
std::array<double, 3> transform_point(const Transform& m, const aiVector3D& p);
std::array<double, 3> transform_vector(const Transform& m, const aiVector3D& v);
bool is_finite(const Transform& m);

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
