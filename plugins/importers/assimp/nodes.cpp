#include "nodes.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace assimp_import {
namespace {

Transform from_assimp(const aiMatrix4x4& m) {
    return {m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4};
}

enum class Part { whole, pivot, geometric, geometric_inverse };

// Helper nodes that assimp's FBX importer adds are recognised by the end of their names.
Part part_of(const aiNode& node) {
    constexpr std::string_view tag = "_$AssimpFbx$_";
    const std::string_view name(node.mName.data, node.mName.length);
    const size_t at = name.rfind(tag);
    if (at == name.npos) return Part::whole;
    const std::string_view part = name.substr(at + tag.size());
    if (part.substr(0, 9) != "Geometric") return Part::pivot;
    return part.size() > 7 && part.substr(part.size() - 7) == "Inverse" ? Part::geometric_inverse : Part::geometric;
}

}  // namespace

Transform multiply(const Transform& a, const Transform& b) {
    Transform m{};
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) {
            double sum = column == 3 ? a[4 * row + 3] : 0;
            for (int k = 0; k < 3; ++k) sum += a[4 * row + k] * b[4 * k + column];
            m[4 * row + column] = sum;
        }
    }
    return m;
}

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

bool is_finite(const Transform& m) {
    return std::all_of(m.begin(), m.end(), [](double x) { return std::isfinite(static_cast<float>(x)); });
}

NodeTree::NodeTree(const aiScene& scene, bool is_fbx) {
    struct Pending {
        const aiNode* node;
        Transform parent;     // inherited by the node
        Transform geometric;  // product of the geometric parts since the last whole node
    };
    std::vector<Pending> stack;
    if (scene.mRootNode) stack.push_back({scene.mRootNode, kIdentity, kIdentity});
    while (!stack.empty()) {
        const Pending at = stack.back();
        stack.pop_back();
        const Transform local = from_assimp(at.node->mTransformation);
        const Part part = is_fbx ? part_of(*at.node) : Part::whole;
        PlacedNode placed;
        placed.node = at.node;
        Transform geometric = kIdentity;  // passed on to the children
        switch (part) {
            case Part::whole:
                placed.world = multiply(at.parent, local);
                placed.world_geometry = multiply(placed.world, at.geometric);
                break;
            case Part::pivot:
                placed.world = placed.world_geometry = multiply(at.parent, local);
                break;
            case Part::geometric:
                placed.world = placed.world_geometry = at.parent;
                geometric = multiply(at.geometric, local);
                break;
            case Part::geometric_inverse:
                placed.world = placed.world_geometry = at.parent;
                break;
        }
        nodes_.push_back(placed);
        // The children go onto the stack in reverse, so that siblings come out in the order of the file.
        for (unsigned i = at.node->mNumChildren; i > 0; --i) {
            if (const aiNode* child = at.node->mChildren[i - 1]) stack.push_back({child, placed.world, geometric});
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
