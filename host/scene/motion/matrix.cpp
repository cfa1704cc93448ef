#include "scene/motion/matrix.hpp"

#include <algorithm>
#include <cmath>

#include "base/angle.hpp"

namespace clarity {
namespace {

// The axes of an order, in the order in which they turn.
struct Axes {
    int first, second, third;
    double sign;  // 1 if the axes follow each other as x, y, z, x do
};
Axes axes_of(rt_u32 order) {
    switch (order) {
        case RT_ROTATE_XZY:
            return {0, 2, 1, -1};
        case RT_ROTATE_YZX:
            return {1, 2, 0, 1};
        case RT_ROTATE_YXZ:
            return {1, 0, 2, -1};
        case RT_ROTATE_ZXY:
            return {2, 0, 1, 1};
        case RT_ROTATE_ZYX:
            return {2, 1, 0, -1};
        default:
            return {0, 1, 2, 1};
    }
}

Quaternion about(int axis, double degrees) {
    Quaternion q = {0, 0, 0, std::cos(degrees * kRadPerDegree / 2)};
    q[axis] = std::sin(degrees * kRadPerDegree / 2);
    return q;
}

}  // namespace

Matrix operator*(const Matrix& a, const Matrix& b) {
    Matrix r{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j)
            r[4 * i + j] = a[4 * i] * b[j] + a[4 * i + 1] * b[4 + j] + a[4 * i + 2] * b[8 + j] + (j == 3 ? a[4 * i + 3] : 0);
    return r;
}

Vec direction(const Matrix& m, const Vec& d) {
    return {m[0] * d[0] + m[1] * d[1] + m[2] * d[2], m[4] * d[0] + m[5] * d[1] + m[6] * d[2],
            m[8] * d[0] + m[9] * d[1] + m[10] * d[2]};
}

Vec point(const Matrix& m, const Vec& p) {
    const Vec d = direction(m, p);
    return {d[0] + m[3], d[1] + m[7], d[2] + m[11]};
}

Matrix linear_part(const Matrix& m) {
    return {m[0], m[1], m[2], 0, m[4], m[5], m[6], 0, m[8], m[9], m[10], 0};
}

Matrix cofactors(const Matrix& m) {
    const Vec x = {m[0], m[1], m[2]}, y = {m[4], m[5], m[6]}, z = {m[8], m[9], m[10]};
    const Vec a = cross(y, z), b = cross(z, x), c = cross(x, y);
    return {a[0], a[1], a[2], 0, b[0], b[1], b[2], 0, c[0], c[1], c[2], 0};
}

double determinant(const Matrix& m) {
    const Matrix c = cofactors(m);
    return m[0] * c[0] + m[1] * c[1] + m[2] * c[2];
}

bool invert(const Matrix& m, Matrix& inverse) {
    const Matrix c = cofactors(m);
    const double d = m[0] * c[0] + m[1] * c[1] + m[2] * c[2];
    // Compare with the lengths of the columns: a model in micrometres has a tiny determinant without being flat.
    double lengths = 1;
    for (int j = 0; j < 3; ++j) lengths *= std::sqrt(m[j] * m[j] + m[4 + j] * m[4 + j] + m[8 + j] * m[8 + j]);
    if (!(std::abs(d) > 1e-12 * lengths)) return false;
    Matrix r = {c[0] / d, c[4] / d, c[8] / d, 0, c[1] / d, c[5] / d, c[9] / d, 0, c[2] / d, c[6] / d, c[10] / d, 0};
    const Vec back = direction(r, {m[3], m[7], m[11]});
    for (int i = 0; i < 3; ++i) r[4 * i + 3] = -back[i];
    inverse = r;
    return std::all_of(r.begin(), r.end(), [](double value) { return std::isfinite(value); });
}

Matrix scaling(const Vec& s) {
    return {s[0], 0, 0, 0, 0, s[1], 0, 0, 0, 0, s[2], 0};
}

Quaternion operator*(const Quaternion& a, const Quaternion& b) {
    return {a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1], a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
            a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3], a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]};
}

Quaternion unit(const Quaternion& q) {
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(length > 0)) return kNoRotation;
    return {q[0] / length, q[1] / length, q[2] / length, q[3] / length};
}

Quaternion slerp(const Quaternion& a, Quaternion b, double t) {
    double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    if (cosine < 0) {
        cosine = -cosine;
        for (double& x : b) x = -x;
    }
    double from = 1 - t, to = t;
    if (cosine < 1 - 1e-12) {
        const double angle = std::acos(std::min(cosine, 1.0)), sine = std::sin(angle);
        from = std::sin((1 - t) * angle) / sine;
        to = std::sin(t * angle) / sine;
    }
    return unit({from * a[0] + to * b[0], from * a[1] + to * b[1], from * a[2] + to * b[2], from * a[3] + to * b[3]});
}

Matrix rotation(const Quaternion& q) {
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    return {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),     0,
            2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),     0,
            2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y), 0};
}

// Shepperd (1978): divides by the largest of the four numbers.
Quaternion quaternion_of(const Matrix& m) {
    const double trace = m[0] + m[5] + m[10];
    const double squares[4] = {1 + 2 * m[0] - trace, 1 + 2 * m[5] - trace, 1 + 2 * m[10] - trace, 1 + trace};
    const int largest = static_cast<int>(std::max_element(squares, squares + 4) - squares);
    if (largest == 3) return unit({m[9] - m[6], m[2] - m[8], m[4] - m[1], squares[3]});
    const int i = largest, j = (i + 1) % 3, k = (i + 2) % 3;
    Quaternion q{};
    q[i] = squares[i];
    q[j] = m[4 * j + i] + m[4 * i + j];
    q[k] = m[4 * k + i] + m[4 * i + k];
    q[3] = m[4 * k + j] - m[4 * j + k];
    return unit(q);
}

Quaternion from_angles(const Vec& degrees, rt_u32 order) {
    const Axes axes = axes_of(order);
    return about(axes.third, degrees[axes.third]) * about(axes.second, degrees[axes.second]) *
           about(axes.first, degrees[axes.first]);
}

// The matrix is R(third) R(second) R(first). With i, j, k = first, second, third and s = sign of the order:
// m[k][i] = -s sin(second), m[k][j] = s cos(second) sin(first), m[k][k] = cos(second) cos(first), and m[j][i], m[i][i] likewise
// hold the third angle.
Vec to_angles(const Quaternion& q, rt_u32 order) {
    const Axes axes = axes_of(order);
    const Matrix m = rotation(q);
    const int i = axes.first, j = axes.second, k = axes.third;
    const double sine = std::clamp(-axes.sign * m[4 * k + i], -1.0, 1.0);
    Vec radians{};
    radians[j] = std::asin(sine);
    if (std::abs(sine) < 1 - 1e-12) {
        radians[i] = std::atan2(axes.sign * m[4 * k + j], m[4 * k + k]);
        radians[k] = std::atan2(axes.sign * m[4 * j + i], m[4 * i + i]);
    } else {  // first and third turn about the same axis
        radians[i] = std::atan2(-axes.sign * m[4 * j + k], m[4 * j + j]);
    }
    return {radians[0] / kRadPerDegree, radians[1] / kRadPerDegree, radians[2] / kRadPerDegree};
}

}  // namespace clarity
