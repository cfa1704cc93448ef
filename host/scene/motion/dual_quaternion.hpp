// dual_quaternion.hpp -- rotations and translations that can be blended without a loss of volume, for skins. Kavan, Collins,
// Zara, O'Sullivan (2008), "Geometric Skinning with Approximate Dual Quaternion Blending".
#pragma once
#include "scene/motion/matrix.hpp"

namespace clarity {

// Scales are kept apart from them, and blended as numbers.
struct DualQuaternion {
    Quaternion real{0, 0, 0, 0}, dual{0, 0, 0, 0};
    Vec scale{};
};

DualQuaternion dual_quaternion(const Matrix& m);
// Adds a share of `d` to a sum.
void add(DualQuaternion& sum, const DualQuaternion& d, double weight);
// The sum need not be of unit length. kIdentityMatrix if it is zero.
Matrix matrix_of(const DualQuaternion& sum);

}  // namespace clarity
