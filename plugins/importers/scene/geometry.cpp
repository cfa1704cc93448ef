#include "geometry.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace scene_format {
namespace {

using Double3 = std::array<double, 3>;

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

}  // namespace scene_format
