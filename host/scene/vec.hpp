// vec.hpp -- vectors of three doubles, for what floats would round too coarsely.
#pragma once
#include <array>
#include <cmath>

namespace clarity {

using Vec = std::array<double, 3>;

inline Vec operator-(const Vec& a, const Vec& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vec operator+(const Vec& a, const Vec& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vec operator-(const Vec& a) {
    return {-a[0], -a[1], -a[2]};
}
inline Vec& operator+=(Vec& a, const Vec& b) {
    return a = a + b;
}
inline Vec operator*(double s, const Vec& a) {
    return {s * a[0], s * a[1], s * a[2]};
}
inline double dot(const Vec& a, const Vec& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline double length(const Vec& a) {
    return std::sqrt(dot(a, a));
}
inline Vec normalized(const Vec& a) {
    return (1 / length(a)) * a;
}
// `otherwise`: of the zero vector.
inline Vec normalized(const Vec& a, const Vec& otherwise) {
    return length(a) > 0 ? normalized(a) : otherwise;
}
inline Vec to_vec(const float* three) {
    return {three[0], three[1], three[2]};
}
inline Vec to_vec(const std::array<float, 3>& a) {
    return to_vec(a.data());
}
inline std::array<float, 3> to_floats(const Vec& a) {
    return {static_cast<float>(a[0]), static_cast<float>(a[1]), static_cast<float>(a[2])};
}
// Whether no channel of a colour is above 0.
inline bool is_black(const float (&color)[3]) {
    return !(color[0] > 0 || color[1] > 0 || color[2] > 0);
}
inline Vec cross(const Vec& a, const Vec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace clarity
