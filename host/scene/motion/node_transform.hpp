// node_transform.hpp -- where nodes are in the world.
#pragma once
#include "scene/motion/matrix.hpp"
#include "scene/motion/motion.hpp"

namespace clarity {

// What channels may change of a node.
struct NodeValues {
    Vec translation{}, scale{1, 1, 1};
    Vec degrees{};          // of a node with angles
    Quaternion rotation{};  // of a node with RT_ROTATE_QUATERNION
    bool visible = true;
};
NodeValues values_at_rest(const rt_node_desc& node);

struct PlacedNode {
    Matrix world = kIdentityMatrix;
    // For child nodes: `world` without its translation is `unscaled` times `scale`, which is the node's own times `inherited`.
    Matrix unscaled = kIdentityMatrix, scale = kIdentityMatrix;
    Matrix inherited = kIdentityMatrix;  // the scale that the node has from nodes above it along its own axes
    bool visible = true;
};
// parent: NULL for a node without one.
PlacedNode place_node(const rt_node_desc& node, const NodeValues& values, const PlacedNode* parent);

}  // namespace clarity
