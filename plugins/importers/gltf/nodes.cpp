#include "nodes.hpp"

#include <algorithm>
#include <array>

#include "../common/matrix.hpp"
#include "rt_plugin.hpp"

namespace gltf_import {
namespace {

// A node has either `matrix`, or translation, rotation and scale. What it lacks keeps the default.
rt_u32 pass(const Value& node, rt_u32 parent, const rt_scene_sink& sink) {
    const std::string name = node.name();
    rt_node_desc out{};
    out.struct_bytes = sizeof out;
    out.parent = parent;
    out.name = name.c_str();
    out.rotation_order = RT_ROTATE_QUATERNION;
    const auto copy = [](const auto& from, double* to) { std::copy(from.begin(), from.end(), to); };
    copy(node.numbers<3>("translation", {0, 0, 0}), out.translation);
    copy(node.numbers<4>("rotation", {0, 0, 0, 1}), out.rotation);
    copy(node.numbers<3>("scale", {1, 1, 1}), out.scale);
    if (node.has("matrix")) {
        copy(importers::from_columns(node.numbers<16>("matrix", {}).data()), out.after_scale);
    }
    return rt::id(sink.node(sink.ctx, &out));
}

}  // namespace

NodeTree::NodeTree(const Document& document, const rt_scene_sink& sink) : list_(document.list("nodes")), nodes_(list_.size()) {
    find_parents();
    const Value scenes = document.list("scenes");
    if (scenes.size() > 0) {
        const Value roots = scenes[document.root().index("scene", scenes).value_or(0)].list("nodes");
        for (size_t i = 0; i < roots.size(); ++i) {
            const size_t root = roots[i].index(list_);
            if (nodes_[root].parent)
                roots[i].refuse(std::to_string(root) + ", which is a child of " + list_[*nodes_[root].parent].path(),
                                "a node that no other node names as a child");
            if (nodes_[root].id != 0) roots[i].refuse("each node once");
            visit(root, true, sink);
        }
    }
    // The rest is not shown, but bones may be there. A file without scenes shows everything.
    for (size_t i = 0; i < nodes_.size(); ++i) {
        if (!nodes_[i].parent && nodes_[i].id == 0) visit(i, scenes.size() == 0, sink);
    }
    for (size_t i = 0; i < nodes_.size(); ++i) {
        if (nodes_[i].id == 0) throw Error(list_[i].path() + ": found a cycle of children, expected a tree of nodes");
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
void NodeTree::visit(size_t root, bool is_shown, const rt_scene_sink& sink) {
    std::vector<size_t> stack = {root};
    while (!stack.empty()) {
        const size_t i = stack.back();
        stack.pop_back();
        Node& node = nodes_[i];
        node.id = pass(list_[i], node.parent ? nodes_[*node.parent].id : 0, sink);
        if (is_shown) shown_.push_back(i);
        const Value children = list_[i].list("children");
        for (size_t k = children.size(); k > 0; --k) stack.push_back(children[k - 1].index(list_));
    }
}

}  // namespace gltf_import
