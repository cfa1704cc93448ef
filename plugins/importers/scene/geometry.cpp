#include "geometry.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace scene_format {
namespace {

using Double3 = std::array<double, 3>;
constexpr double kPi = 3.14159265358979323846;

Double3 point(const float* p, const Double3& origin) {
    return {p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]};
}
Double3 cross(const Double3& a, const Double3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Double3& a, const Double3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double box_size(const float* corners, size_t count) {
    double size = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
        float low = corners[axis], high = low;
        for (size_t i = 1; i < count; ++i) {
            low = std::min(low, corners[3 * i + axis]);
            high = std::max(high, corners[3 * i + axis]);
        }
        size = std::max(size, double{high} - double{low});
    }
    return size;
}

// Twice the vector area (Newell's method). Coordinates are relative to the first corner, so that a polygon far from the origin
// loses no precision.
Double3 newell_normal(const float* corners, size_t count) {
    const Double3 origin{corners[0], corners[1], corners[2]};
    Double3 sum{};
    for (size_t i = 0; i < count; ++i) {
        const Double3 c = cross(point(corners + 3 * i, origin), point(corners + 3 * ((i + 1) % count), origin));
        for (size_t axis = 0; axis < 3; ++axis) sum[axis] += c[axis];
    }
    return sum;
}

}  // namespace

std::string polygon_fault(const std::vector<float>& corners) {
    const size_t count = corners.size() / 3;
    const double size = box_size(corners.data(), count);
    Double3 normal = newell_normal(corners.data(), count);
    const double length = std::sqrt(dot(normal, normal));
    if (!(length > 2 * kAreaTolerance * size * size)) {
        return "the polygon has no area (its corners lie on a line or cancel out); expected a surface";
    }
    for (double& component : normal) component /= length;
    const Double3 origin{corners[0], corners[1], corners[2]};
    double mean = 0;
    for (size_t i = 0; i < count; ++i) mean += dot(normal, point(&corners[3 * i], origin)) / static_cast<double>(count);
    size_t worst_corner = 0;
    double worst = 0;
    for (size_t i = 0; i < count; ++i) {
        const double distance = std::fabs(dot(normal, point(&corners[3 * i], origin)) - mean);
        if (distance > worst) {
            worst = distance;
            worst_corner = i + 1;
        }
    }
    if (worst <= kPlanarTolerance * size) return {};
    char text[160];
    std::snprintf(text, sizeof text,
                  "corner %zu lies %.3g off the plane of the polygon; expected at most %.3g (%g of its size)", worst_corner,
                  worst, kPlanarTolerance * size, kPlanarTolerance);
    return text;
}

bool triangle_is_degenerate(const std::array<float, 9>& corners) {
    const double size = box_size(corners.data(), 3);
    const Double3 normal = newell_normal(corners.data(), 3);
    return !(std::sqrt(dot(normal, normal)) > 2 * kAreaTolerance * size * size);
}

void Placement::rotate(const Vec3& unit_axis, float degrees) {
    const double angle = std::fmod(double{degrees}, 360.0) * kPi / 180.0;
    const double s = std::sin(angle), c = std::cos(angle), t = 1 - c;
    const double x = unit_axis[0], y = unit_axis[1], z = unit_axis[2];
    // Rodrigues' rotation formula.
    const std::array<double, 9> turn = {t * x * x + c,     t * x * y - s * z, t * x * z + s * y,  //
                                        t * x * y + s * z, t * y * y + c,     t * y * z - s * x,  //
                                        t * x * z - s * y, t * y * z + s * x, t * z * z + c};
    std::array<double, 9> product{};
    for (size_t row = 0; row < 3; ++row) {
        for (size_t column = 0; column < 3; ++column) {
            for (size_t k = 0; k < 3; ++k) product[3 * row + column] += turn[3 * row + k] * rotation_[3 * k + column];
        }
    }
    rotation_ = product;
}

std::array<float, 12> Placement::world_from_object() const {
    std::array<float, 12> m{};
    for (size_t row = 0; row < 3; ++row) {
        for (size_t column = 0; column < 3; ++column) {
            m[4 * row + column] = static_cast<float>(rotation_[3 * row + column] * double{scale_[column]});
        }
        m[4 * row + 3] = translate_[row];
    }
    return m;
}

}  // namespace scene_format
