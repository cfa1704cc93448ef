// vec.hpp -- a vector of three doubles.
#pragma once
#include <cmath>

namespace clarity::reference {

struct Vec {
    double x = 0, y = 0, z = 0;
    double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
};

inline Vec operator+(Vec a, Vec b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec operator-(Vec a, Vec b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec operator-(Vec a) {
    return {-a.x, -a.y, -a.z};
}
inline Vec operator*(double s, Vec a) {
    return {s * a.x, s * a.y, s * a.z};
}
inline Vec operator*(Vec a, Vec b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline double dot(Vec a, Vec b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec cross(Vec a, Vec b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec a) {
    return std::sqrt(dot(a, a));
}
inline Vec normalize(Vec a) {
    return (1 / length(a)) * a;
}
inline double largest(Vec a) {
    return std::fmax(a.x, std::fmax(a.y, a.z));
}
template <class Array>
Vec vec_of(const Array& a) {
    return {double(a[0]), double(a[1]), double(a[2])};
}

}  // namespace clarity::reference
