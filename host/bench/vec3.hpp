// vec3.hpp -- vectors in double precision, for what is made on the host.
#pragma once
#include <array>
#include <cmath>

namespace clarity {

using Vec3 = std::array<double, 3>;

inline Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vec3 operator*(double s, const Vec3& a) {
    return {s * a[0], s * a[1], s * a[2]};
}
inline double dot(const Vec3& a, const Vec3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
// `otherwise` for a vector of no length.
inline Vec3 normalized(const Vec3& a, const Vec3& otherwise) {
    const double length = std::sqrt(dot(a, a));
    return length > 0 ? (1 / length) * a : otherwise;
}

}  // namespace clarity
