// matrix.hpp -- affine maps of doubles, for chains of nodes whose rounding errors would add up.
#pragma once
#include <array>

#include "scene/scene.hpp"
#include "scene/vec.hpp"

namespace clarity {

// Row-major 3x4 matrix, as Affine.
using Matrix = std::array<double, 12>;
inline constexpr Matrix kIdentityMatrix = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

inline Matrix to_matrix(const Affine& m) {
    Matrix r{};
    for (int i = 0; i < 12; ++i) r[i] = m[i];
    return r;
}
inline Affine to_affine(const Matrix& m) {
    Affine r{};
    for (int i = 0; i < 12; ++i) r[i] = static_cast<float>(m[i]);
    return r;
}

Matrix operator*(const Matrix& a, const Matrix& b);  // applies b first, then a
Vec point(const Matrix& m, const Vec& p);            // m p
Vec direction(const Matrix& m, const Vec& d);        // the linear part of m, times d
Matrix linear_part(const Matrix& m);                 // m without its translation
double determinant(const Matrix& m);                 // of the linear part
// The cofactors of the linear part, without translation: they turn normals, up to their length. The inverse is their transpose,
// divided by the determinant.
Matrix cofactors(const Matrix& m);
bool invert(const Matrix& m, Matrix& inverse);  // false if m is singular
Matrix scaling(const Vec& s);

// A rotation; x, y, z, w.
using Quaternion = std::array<double, 4>;
inline constexpr Quaternion kNoRotation = {0, 0, 0, 1};
Quaternion operator*(const Quaternion& a, const Quaternion& b);  // rotates by b first, then by a
Quaternion unit(const Quaternion& q);                            // kNoRotation if q is zero
// Between two rotations, along the shorter arc. t: 0 gives a, 1 gives b.
Quaternion slerp(const Quaternion& a, Quaternion b, double t);
Matrix rotation(const Quaternion& q);
Quaternion quaternion_of(const Matrix& rotation);  // the linear part must be a rotation

// Angles in degrees about x, y and z, applied one after the other in an order of rt_plugin.h: RT_ROTATE_XYZ turns about x
// first.
Quaternion from_angles(const Vec& degrees, rt_u32 order);
Vec to_angles(const Quaternion& q, rt_u32 order);

}  // namespace clarity
