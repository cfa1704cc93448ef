// transform.hpp -- matrices of the file, and the transform of a node.
#pragma once
#include "../common/matrix.hpp"

#include "properties.hpp"
#include "rt_plugin.h"

namespace fbx_import {

// A matrix of 16 numbers as the file writes them, column by column; false if there are fewer.
bool matrix_of(const std::vector<double>& numbers, Transform& out);

// translation * before_rotation * rotation * after_rotation * scale * after_scale, as rt_node_desc has it.
struct NodeTransform {
    Vec3 translation{}, rotation{}, scale{1, 1, 1};
    rt_u32 rotation_order = RT_ROTATE_XYZ, inherit = RT_INHERIT_RSRS;
    Transform before_rotation = kIdentity, after_rotation = kIdentity, after_scale = kIdentity;
    Transform geometry = kIdentity;  // of the node's own meshes only
};
NodeTransform node_transform(const Properties& properties);

}  // namespace fbx_import
