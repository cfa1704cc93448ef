#include "transform.hpp"

#include <algorithm>
#include <cmath>

namespace fbx_import {

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

Transform inverse(const Transform& m) {
    const auto minor = [&](int r0, int r1, int c0, int c1) {
        return m[4 * r0 + c0] * m[4 * r1 + c1] - m[4 * r0 + c1] * m[4 * r1 + c0];
    };
    const double determinant = m[0] * minor(1, 2, 1, 2) - m[1] * minor(1, 2, 0, 2) + m[2] * minor(1, 2, 0, 1);
    if (determinant == 0 || !std::isfinite(1 / determinant)) return kIdentity;
    const double d = 1 / determinant;
    Transform out = {minor(1, 2, 1, 2) * d,  -minor(0, 2, 1, 2) * d, minor(0, 1, 1, 2) * d,  0,
                     -minor(1, 2, 0, 2) * d, minor(0, 2, 0, 2) * d,  -minor(0, 1, 0, 2) * d, 0,
                     minor(1, 2, 0, 1) * d,  -minor(0, 2, 0, 1) * d, minor(0, 1, 0, 1) * d,  0};
    const Vec3 back = transform_vector(out, {m[3], m[7], m[11]});
    for (int k = 0; k < 3; ++k) out[4 * k + 3] = -back[k];
    return out;
}

Transform translation(const Vec3& by) {
    return {1, 0, 0, by[0], 0, 1, 0, by[1], 0, 0, 1, by[2]};
}

Transform scaling(const Vec3& by) {
    return {by[0], 0, 0, 0, 0, by[1], 0, 0, 0, 0, by[2], 0};
}

Transform rotation(const Vec3& degrees, rt_u32 order) {
    // The axes in the order in which they turn, of RT_ROTATE_XYZ and its successors.
    static constexpr int axes[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {1, 0, 2}, {2, 0, 1}, {2, 1, 0}};
    Transform out = kIdentity;
    for (const int axis : axes[order < 6 ? order : 0]) {
        const double angle = std::fmod(degrees[axis], 360.0) * 0.017453292519943295, c = std::cos(angle), s = std::sin(angle);
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        Transform turn = kIdentity;
        turn[5 * u] = turn[5 * v] = c;
        turn[4 * u + v] = -s;
        turn[4 * v + u] = s;
        out = multiply(turn, out);
    }
    return out;
}

Vec3 transform_vector(const Transform& m, const Vec3& v) {
    Vec3 r{};
    for (int row = 0; row < 3; ++row) r[row] = m[4 * row] * v[0] + m[4 * row + 1] * v[1] + m[4 * row + 2] * v[2];
    return r;
}

Vec3 transform_point(const Transform& m, const Vec3& p) {
    Vec3 r = transform_vector(m, p);
    for (int row = 0; row < 3; ++row) r[row] += m[4 * row + 3];
    return r;
}

bool is_finite(const Transform& m) {
    return std::all_of(m.begin(), m.end(), [](double x) { return std::isfinite(static_cast<float>(x)); });
}

bool matrix_of(const std::vector<double>& numbers, Transform& out) {
    if (numbers.size() < 16) return false;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) out[4 * row + column] = numbers[4 * column + row];
    }
    return true;
}

// A node's own transform is T Roff Rp Rpre R Rpost^-1 Rp^-1 Soff Sp S Sp^-1. Source: FBX SDK help, "Computing transformation
// matrices". Pre- and post-rotation always turn in the order xyz, and they and the rotation order count only if RotationActive
// is set. Geometric transforms turn in the order xyz. Source: FBX SDK help, "FbxNode"; measured from
// casegen_rotation_space_7500_ascii and max_geometry_transform_7700_ascii.
NodeTransform node_transform(const Properties& p) {
    NodeTransform out;
    const Vec3 zero{}, one{1, 1, 1};
    out.translation = p.vector("Lcl Translation", zero);
    out.rotation = p.vector("Lcl Rotation", zero);
    out.scale = p.vector("Lcl Scaling", one);
    const bool active = p.whole("RotationActive", 0) != 0;
    const int64_t order = active ? p.whole("RotationOrder", 0) : 0;
    out.rotation_order = order >= 0 && order <= 5 ? static_cast<rt_u32>(order) : rt_u32(RT_ROTATE_XYZ);  // 6: spheric xyz
    // 0 RrSs, 1 RSrs, 2 Rrs. Source: FBX SDK help, "FbxTransform::EInheritType".
    const int64_t inherit = p.whole("InheritType", 1);
    out.inherit = inherit == 0 ? RT_INHERIT_RRSS : inherit == 2 ? RT_INHERIT_RRS : RT_INHERIT_RSRS;
    const Vec3 pivot = p.vector("RotationPivot", zero), scale_pivot = p.vector("ScalingPivot", zero);
    const Vec3 offset = p.vector("RotationOffset", zero), scale_offset = p.vector("ScalingOffset", zero);
    Vec3 to_pivot, from_pivot, back;
    for (int k = 0; k < 3; ++k) {
        to_pivot[k] = offset[k] + pivot[k];
        from_pivot[k] = -pivot[k] + scale_offset[k] + scale_pivot[k];
        back[k] = -scale_pivot[k];
    }
    out.before_rotation = translation(to_pivot);
    out.after_rotation = translation(from_pivot);
    out.after_scale = translation(back);
    if (active) {
        out.before_rotation = multiply(out.before_rotation, rotation(p.vector("PreRotation", zero)));
        out.after_rotation = multiply(inverse(rotation(p.vector("PostRotation", zero))), out.after_rotation);
    }
    out.geometry =
        multiply(translation(p.vector("GeometricTranslation", zero)),
                 multiply(rotation(p.vector("GeometricRotation", zero)), scaling(p.vector("GeometricScaling", one))));
    return out;
}

// The global rotation and scale of the three modes: R S r s, R r S s, and R r (S without the parent's own scale) s. The
// translation is where the parent's matrix takes the node's own. Source: FBX SDK help, "Computing transformation matrices".
World place(const NodeTransform& node, const World* parent) {
    const Transform turn =
        multiply(multiply(node.before_rotation, rotation(node.rotation, node.rotation_order)), node.after_rotation);
    const Transform own =
        multiply(multiply(translation(node.translation), turn), multiply(scaling(node.scale), node.after_scale));
    World out;
    out.own_scale = node.scale;
    if (!parent || node.inherit == RT_INHERIT_RSRS) {
        out.matrix = parent ? multiply(parent->matrix, own) : own;
    }
    Transform linear = turn;
    for (const int k : {3, 7, 11}) linear[k] = 0;
    out.rotation = parent ? multiply(parent->rotation, linear) : linear;
    Transform above = parent ? parent->scale : kIdentity;
    if (parent && node.inherit == RT_INHERIT_RRS) above = multiply(above, inverse(scaling(parent->own_scale)));
    if (parent && node.inherit != RT_INHERIT_RSRS) {
        out.matrix = multiply(out.rotation, multiply(above, scaling(node.scale)));
        const Vec3 at = transform_point(parent->matrix, {own[3], own[7], own[11]});
        for (int k = 0; k < 3; ++k) out.matrix[4 * k + 3] = at[k];
    }
    // What is left of the matrix without its rotation.
    Transform scale = multiply(inverse(out.rotation), out.matrix);
    for (const int k : {3, 7, 11}) scale[k] = 0;
    out.scale = scale;
    return out;
}

}  // namespace fbx_import
