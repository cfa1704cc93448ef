// transform.hpp -- matrices, and what moves a node.
#pragma once
#include <array>

#include "properties.hpp"
#include "rt_plugin.h"

namespace fbx_import {

// A 3x4 matrix, row-major, in double precision, so that chains of many small rotations stay exact to float precision.
using Transform = std::array<double, 12>;
inline constexpr Transform kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

Transform multiply(const Transform& a, const Transform& b);  // applies b first, then a
Transform transposed(const Transform& m);                    // its 3x3 part, which for a rotation is the inverse
Transform translation(const Vec3& by);
Transform scaling(const Vec3& by);
Transform rotation(const Vec3& degrees, rt_u32 order = RT_ROTATE_XYZ);
bool is_finite(const Transform& m);  // also as floats
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
