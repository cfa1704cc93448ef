// nodes.hpp -- the tree of nodes, with its cameras and lights.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "accessors.hpp"
#include "document.hpp"
#include "rt_plugin.h"

namespace gltf_import {

class NodeTree {
 public:
    // Passes all nodes to the sink. Refuses cycles and nodes with two parents.
    NodeTree(const Document& document, const rt_scene_sink& sink);

    const Value& list() const { return list_; }
    // The nodes of the scene, parents first.
    const std::vector<size_t>& shown() const { return shown_; }
    // The sink's id of a node.
    rt_u32 id(size_t node) const { return nodes_[node].id; }
    std::string name(size_t node) const { return list_[node].name(); }

 private:
    struct Node {
        std::optional<size_t> parent;
        rt_u32 id = 0;  // 0: the sink does not have it yet
    };
    void find_parents();
    void visit(size_t root, bool is_shown, const rt_scene_sink& sink);

    const Value list_;
    std::vector<Node> nodes_;
    std::vector<size_t> shown_;
};

void add_cameras(const Document& document, const NodeTree& tree, const rt_scene_sink& sink);
// The lights of KHR_lights_punctual.
void add_lights(const Document& document, const NodeTree& tree, const rt_host* host, const rt_scene_sink& sink);
// The light from all around of EXT_lights_image_based.
void add_sky(const Document& document, Accessors& accessors, const rt_scene_sink& sink);

}  // namespace gltf_import
