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

PlacedNode place_node(const rt_node_desc& node, const NodeValues& values, const PlacedNode* parent) {
    const Quaternion q =
        node.rotation_order == RT_ROTATE_QUATERNION ? values.rotation : from_angles(values.degrees, node.rotation_order);
    const Matrix turn = matrix(node.before_rotation) * rotation(q) * matrix(node.after_rotation);
    PlacedNode placed;
    placed.scale = scaling(values.scale);
    Matrix local = turn * placed.scale * matrix(node.after_scale);
    for (int i = 0; i < 3; ++i) local[4 * i + 3] += values.translation[i];
    placed.visible = values.visible && (!parent || parent->visible || (node.flags & RT_NODE_OWN_VISIBILITY));
    placed.rotation = linear_part(turn);
    placed.world = local;
    if (!parent) return placed;
    placed.rotation = parent->rotation * placed.rotation;
    placed.world = parent->world * local;
    if (node.inherit == RT_INHERIT_RSRS) return placed;
    // "Computing transformation matrices" of the FBX SDK's help: the parent's scale is its linear part without its rotation, so
    // that shear counts as scale.
    Matrix unturned, unscaled;
    if (!invert(parent->rotation, unturned)) return placed;
    Matrix scale = unturned * linear_part(parent->world);
    if (node.inherit == RT_INHERIT_RRS && invert(parent->scale, unscaled)) scale = scale * unscaled;
    const Matrix linear = placed.rotation * scale * placed.scale;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) placed.world[4 * i + j] = linear[4 * i + j];
    return placed;
}

}  // namespace clarity
