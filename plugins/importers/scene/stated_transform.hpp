// stated_transform.hpp -- the transform of a loaded file.
#pragma once
#include <array>

namespace scene_format {

using Vec3 = std::array<float, 3>;
using Rotation = std::array<double, 9>;  // row-major

// Counter-clockwise, seen from the tip of the axis.
Rotation rotation_about(const Vec3& unit_axis, double degrees);
// The unit quaternion x y z w of the same rotation.
std::array<double, 4> quaternion_about(const Vec3& unit_axis, double degrees);

// First scale, then the rotations in their order, then the translation.
class StatedTransform {
 public:
    void scale(const Vec3& factors) { scale_ = factors; }
    void rotate(const Vec3& unit_axis, float degrees);
    void translate(const Vec3& by) { translate_ = by; }

    const Vec3& translation() const { return translate_; }
    const Vec3& scales() const { return scale_; }
    // All rotations as one quaternion x y z w.
    const std::array<double, 4>& quaternion() const { return quaternion_; }
    std::array<float, 12> world_from_object() const;  // row-major 3x4

 private:
    Vec3 scale_{1, 1, 1}, translate_{0, 0, 0};
    Rotation rotation_{1, 0, 0, 0, 1, 0, 0, 0, 1};
    std::array<double, 4> quaternion_{0, 0, 0, 1};
};

}  // namespace scene_format
