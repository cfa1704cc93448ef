#include "nodes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rt_plugin.hpp"

namespace gltf_import {
namespace {

// What a node has: either `matrix`, or the other three. The file's matrices are column-major.
struct Local {
    std::array<double, 3> translation, scale;
    std::array<double, 4> rotation;
    Transform matrix = kIdentity;
};

Local local_of(const Value& node) {
    Local local;
    local.translation = node.numbers<3>("translation", {0, 0, 0});
    local.rotation = node.numbers<4>("rotation", {0, 0, 0, 1});
    local.scale = node.numbers<3>("scale", {1, 1, 1});
    if (node.has("matrix")) {
        const std::array<double, 16> m = node.numbers<16>("matrix", {});
        for (size_t row = 0; row < 3; ++row) {
            for (size_t column = 0; column < 4; ++column) local.matrix[4 * row + column] = m[4 * column + row];
        }
    }
    return local;
}

Transform transform_of(const Local& local) {
    auto [x, y, z, w] = local.rotation;
    const double length = std::sqrt(x * x + y * y + z * z + w * w);
    const double n = length > 0 && std::isfinite(length) ? 1 / length : 0;
    x *= n, y *= n, z *= n, w *= n;
    const auto [sx, sy, sz] = local.scale;
    const Transform m = {(1 - 2 * (y * y + z * z)) * sx, 2 * (x * y - z * w) * sy,       2 * (x * z + y * w) * sz,
                         local.translation[0],           2 * (x * y + z * w) * sx,       (1 - 2 * (x * x + z * z)) * sy,
                         2 * (y * z - x * w) * sz,       local.translation[1],           2 * (x * z - y * w) * sx,
                         2 * (y * z + x * w) * sy,       (1 - 2 * (x * x + y * y)) * sz, local.translation[2]};
    return multiply(m, local.matrix);
}

}  // namespace

float to_float(double x) {
    constexpr double kMost = std::numeric_limits<float>::max();
    return x >= -kMost && x <= kMost ? static_cast<float>(x) : std::numeric_limits<float>::infinity();
}

NodeTree::NodeTree(const Document& document, const rt_scene_sink& sink, bool moves)
    : list_(document.list("nodes")), nodes_(list_.size()) {
    find_parents();
    const Value scenes = document.list("scenes");
    if (scenes.size() > 0) {
        const Value roots = scenes[document.root().index("scene", scenes).value_or(0)].list("nodes");
        for (size_t i = 0; i < roots.size(); ++i) {
            const size_t root = roots[i].index(list_);
            if (nodes_[root].parent)
                roots[i].refuse(std::to_string(root) + ", which is a child of " + list_[*nodes_[root].parent].path(),
                                "a node that no other node names as a child");
            if (nodes_[root].is_done) roots[i].refuse("each node once");
            visit(root, true, sink, moves);
        }
    }
    // The rest is not shown, but bones may be there. A file without scenes shows everything.
    for (size_t i = 0; i < nodes_.size(); ++i) {
        if (!nodes_[i].parent && !nodes_[i].is_done) visit(i, scenes.size() == 0, sink, moves);
    }
    for (size_t i = 0; i < nodes_.size(); ++i) {
        if (!nodes_[i].is_done) throw Error(list_[i].path() + ": found a cycle of children, expected a tree of nodes");
    }
}

void NodeTree::find_parents() {
    for (size_t i = 0; i < nodes_.size(); ++i) {
        const Value children = list_[i].list("children");
        for (size_t k = 0; k < children.size(); ++k) {
            Node& child = nodes_[children[k].index(list_)];
            if (child.parent)
                children[k].refuse(children[k].json().dump() + ", which is a child of " + list_[*child.parent].path() + ", too",
                                   "a node without another parent");
            child.parent = i;
        }
    }
}

// Without recursion, because trees may be deep. Parents come before their children, and siblings in the order of the file.
void NodeTree::visit(size_t root, bool is_shown, const rt_scene_sink& sink, bool moves) {
    std::vector<size_t> stack = {root};
    while (!stack.empty()) {
        const size_t i = stack.back();
        stack.pop_back();
        Node& node = nodes_[i];
        node.is_done = true;
        const Value value = list_[i];
        const Local local = local_of(value);
        const Transform own = transform_of(local);
        node.world = node.parent ? multiply(nodes_[*node.parent].world, own) : own;
        if (moves) {
            const std::string name = this->name(i);
            rt_node_desc out{};
            out.struct_bytes = sizeof out;
            out.parent = node.parent ? nodes_[*node.parent].id : 0;
            out.name = name.c_str();
            out.rotation_order = RT_ROTATE_QUATERNION;
            std::copy(local.translation.begin(), local.translation.end(), out.translation);
            std::copy(local.rotation.begin(), local.rotation.end(), out.rotation);
            std::copy(local.scale.begin(), local.scale.end(), out.scale);
            std::copy(local.matrix.begin(), local.matrix.end(), out.after_scale);
            node.id = rt::id(sink.node(sink.ctx, &out));
        }
        if (is_shown) shown_.push_back(i);
        const Value children = value.list("children");
        for (size_t k = children.size(); k > 0; --k) stack.push_back(children[k - 1].index(list_));
    }
}

}  // namespace gltf_import
