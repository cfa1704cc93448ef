// matrix.hpp -- matrices in double precision, for importers.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "numbers.hpp"

namespace importers {

using Vec3 = std::array<double, 3>;
// A 3x4 matrix, row-major, in double precision, so that chains of many small rotations stay exact to float precision.
using Transform = std::array<double, 12>;
inline constexpr Transform kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

// From 16 numbers, column by column.
template <class Number>
Transform from_columns(const Number* numbers) {
    Transform m{};
    for (int i = 0; i < 12; ++i) m[i] = numbers[4 * (i % 4) + i / 4];
    return m;
}

// Applies b first, then a.
inline Transform multiply(const Transform& a, const Transform& b) {
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

// The 3x3 part transposed, which is the inverse of a rotation.
inline Transform transposed(const Transform& m) {
    return {m[0], m[4], m[8], 0, m[1], m[5], m[9], 0, m[2], m[6], m[10], 0};
}

// False: the matrix is singular.
inline bool invert(const Transform& m, Transform& out) {
    const auto minor = [&](int a, int b, int c, int d) { return m[a] * m[d] - m[b] * m[c]; };
    out = {minor(5, 6, 9, 10), minor(2, 1, 10, 9), minor(1, 2, 5, 6), 0,
           minor(6, 4, 10, 8), minor(0, 2, 8, 10), minor(2, 0, 6, 4), 0,
           minor(4, 5, 8, 9),  minor(1, 0, 9, 8),  minor(0, 1, 4, 5), 0};
    const double determinant = m[0] * out[0] + m[1] * out[4] + m[2] * out[8];
    if (!(std::abs(determinant) > 0) || !std::isfinite(1 / determinant)) return false;
    for (double& x : out) x /= determinant;
    for (int i = 0; i < 12; i += 4) out[i + 3] = -(out[i] * m[3] + out[i + 1] * m[7] + out[i + 2] * m[11]);
    return true;
}

inline Transform translation(const Vec3& by) {
    return {1, 0, 0, by[0], 0, 1, 0, by[1], 0, 0, 1, by[2]};
}

inline Transform scaling(const Vec3& by) {
    return {by[0], 0, 0, 0, 0, by[1], 0, 0, 0, 0, by[2], 0};
}

// Angles about x, y and z.
inline Transform rotation(const Vec3& degrees, unsigned order = 0) {
    // The axes in the order in which they turn: of RT_ROTATE_XYZ, which is 0, and its successors.
    static constexpr int axes[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {1, 0, 2}, {2, 0, 1}, {2, 1, 0}};
    Transform out = kIdentity;
    for (const int axis : axes[order < 6 ? order : 0]) {
        const double angle = std::fmod(degrees[axis], 360.0) * kRadPerDegree, c = std::cos(angle), s = std::sin(angle);
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        Transform turn = kIdentity;
        turn[5 * u] = turn[5 * v] = c;
        turn[4 * u + v] = -s;
        turn[4 * v + u] = s;
        out = multiply(turn, out);
    }
    return out;
}

// Whether it is finite also in floats.
inline bool is_finite(const Transform& m) {
    return std::all_of(m.begin(), m.end(), [](double x) { return std::isfinite(static_cast<float>(x)); });
}

}  // namespace importers
