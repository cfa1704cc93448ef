#include "scene/motion/node_transform.hpp"

namespace clarity {
namespace {

Matrix matrix(const double (&m)[12]) {
    Matrix r{};
    for (int i = 0; i < 12; ++i) r[i] = m[i];
    return r;
}

}  // namespace

NodeValues values_at_rest(const rt_node_desc& node) {
    NodeValues values;
    for (int i = 0; i < 3; ++i) {
        values.translation[i] = node.translation[i];
        values.scale[i] = node.scale[i];
        values.degrees[i] = node.rotation[i];
    }
    values.rotation = unit({node.rotation[0], node.rotation[1], node.rotation[2], node.rotation[3]});
    values.visible = !(node.flags & RT_NODE_HIDDEN);
    return values;
}

// The scale of nodes that inherit it in FBX's ways RrSs and Rrs stays apart from their rotation, down to the next node of the
// way RSrs. "Computing transformation matrices" of the FBX SDK's help computes the same from matrices, but turns the scales of
// nodes farther up with the rotations of those below. Maya, whose segment scale compensation is the way Rrs, does not: its
// frames of maya_mixed_inherit_mode_7700_ascii (ufbx) tell the two apart.
PlacedNode place_node(const rt_node_desc& node, const NodeValues& values, const PlacedNode* parent) {
    const Quaternion q =
        node.rotation_order == RT_ROTATE_QUATERNION ? values.rotation : from_angles(values.degrees, node.rotation_order);
    const Matrix turn = matrix(node.before_rotation) * rotation(q) * matrix(node.after_rotation);
    const Matrix own_scale = scaling(values.scale);
    Matrix local = turn * own_scale * matrix(node.after_scale);
    for (int i = 0; i < 3; ++i) local[4 * i + 3] += values.translation[i];
    PlacedNode placed;
    placed.visible = values.visible && (!parent || parent->visible || (node.flags & RT_NODE_OWN_VISIBILITY));
    placed.world = parent ? parent->world * local : local;
    placed.scale = own_scale;
    placed.unscaled = linear_part(turn);
    if (!parent) return placed;
    if (node.inherit == RT_INHERIT_RSRS) {
        placed.unscaled = linear_part(parent->world) * placed.unscaled;
        return placed;
    }
    placed.unscaled = parent->unscaled * placed.unscaled;
    placed.inherited = node.inherit == RT_INHERIT_RRS ? parent->inherited : parent->scale;
    placed.scale = own_scale * placed.inherited;
    const Matrix linear = placed.unscaled * placed.scale;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) placed.world[4 * i + j] = linear[4 * i + j];
    return placed;
}

}  // namespace clarity
