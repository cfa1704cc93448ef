#include "nodes.hpp"

#include <algorithm>
#include <cmath>

namespace assimp_import {
namespace {

Transform from_assimp(const aiMatrix4x4& m) {
    return {m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4};
}

}  // namespace

std::array<double, 3> transform_vector(const Transform& m, const aiVector3D& v) {
    std::array<double, 3> r{};
    for (int row = 0; row < 3; ++row) r[row] = m[4 * row] * v.x + m[4 * row + 1] * v.y + m[4 * row + 2] * v.z;
    return r;
}

std::array<double, 3> transform_point(const Transform& m, const aiVector3D& p) {
    std::array<double, 3> r = transform_vector(m, p);
    for (int row = 0; row < 3; ++row) r[row] += m[4 * row + 3];
    return r;
}

NodeTree::NodeTree(const aiScene& scene) {
    struct Pending {
        const aiNode* node;
        Transform parent;  // inherited by the node
    };
    std::vector<Pending> stack;
    if (scene.mRootNode) stack.push_back({scene.mRootNode, kIdentity});
    while (!stack.empty()) {
        const Pending at = stack.back();
        stack.pop_back();
        nodes_.push_back({at.node, multiply(at.parent, from_assimp(at.node->mTransformation))});
        const Transform world = nodes_.back().world;
        // The children go onto the stack in reverse, so that siblings come out in the order of the file.
        for (unsigned i = at.node->mNumChildren; i > 0; --i) {
            if (const aiNode* child = at.node->mChildren[i - 1]) stack.push_back({child, world});
        }
    }
    for (size_t i = 0; i < nodes_.size(); ++i) {
        by_name_[std::string(nodes_[i].node->mName.data, nodes_[i].node->mName.length)].push_back(i);
    }
}

const PlacedNode* NodeTree::find(const std::string& name, size_t n) const {
    const auto found = by_name_.find(name);
    if (found == by_name_.end()) return nullptr;
    return &nodes_[found->second[std::min(n, found->second.size() - 1)]];
}

}  // namespace assimp_import
