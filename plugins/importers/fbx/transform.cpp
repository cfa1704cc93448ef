#include "transform.hpp"

#include <algorithm>
#include <cmath>

namespace fbx_import {

bool matrix_of(const std::vector<double>& numbers, Transform& out) {
    if (numbers.size() < 16) return false;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) out[4 * row + column] = numbers[4 * column + row];
    }
    return true;
}

// A node's own transform is T Roff Rp Rpre R Rpost^-1 Rp^-1 Soff Sp S Sp^-1. Source: FBX SDK help, "Computing transformation
// matrices". Pre- and post-rotation always turn in the order xyz, and like the rotation order they count only if RotationActive
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
        out.after_rotation = multiply(transposed(rotation(p.vector("PostRotation", zero))), out.after_rotation);
    }
    out.geometry =
        multiply(translation(p.vector("GeometricTranslation", zero)),
                 multiply(rotation(p.vector("GeometricRotation", zero)), scaling(p.vector("GeometricScaling", one))));
    return out;
}

}  // namespace fbx_import
