// nodes.hpp -- the tree of nodes, and the cameras and lights that hang on it.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "../common/matrix.hpp"
#include "document.hpp"
#include "rt_plugin.h"

namespace gltf_import {

using importers::kIdentity;
using importers::multiply;
using importers::Transform;

// Infinite if the number is too large for a float.
float to_float(double x);

class NodeTree {
 public:
    // Refuses cycles and nodes with two parents. Nodes go to the sink if `moves`.
    NodeTree(const Document& document, const rt_scene_sink& sink, bool moves);

    const Value& list() const { return list_; }
    // The nodes of the scene, parents first.
    const std::vector<size_t>& shown() const { return shown_; }
    // The sink's id of a node; 0: the sink has no nodes.
    rt_u32 id(size_t node) const { return nodes_[node].id; }
    std::string name(size_t node) const { return list_[node].text("name", ""); }
    // From the node's space to that of the node `id`, or to the world if the sink has no nodes.
    const Transform& placed(size_t node) const { return id(node) ? kIdentity : nodes_[node].world; }

 private:
    struct Node {
        std::optional<size_t> parent;
        bool is_done = false;
        Transform world = kIdentity;
        rt_u32 id = 0;
    };
    void find_parents();
    void visit(size_t root, bool is_shown, const rt_scene_sink& sink, bool moves);

    const Value list_;
    std::vector<Node> nodes_;
    std::vector<size_t> shown_;
};

void add_cameras(const Document& document, const NodeTree& tree, const rt_scene_sink& sink);
// The lights of KHR_lights_punctual.
void add_lights(const Document& document, const NodeTree& tree, const rt_host* host, const rt_scene_sink& sink);

}  // namespace gltf_import
