#include "stated_transform.hpp"

#include <cmath>
#include <cstddef>

#include "../common/numbers.hpp"

namespace scene_format {
namespace {

constexpr double kDegree = importers::kRadPerDegree;

}  // namespace

Rotation rotation_about(const Vec3& unit_axis, double degrees) {
    const double angle = std::fmod(degrees, 360.0) * kDegree;
    const double s = std::sin(angle), c = std::cos(angle), t = 1 - c;
    const double x = unit_axis[0], y = unit_axis[1], z = unit_axis[2];
    // Rodrigues' rotation formula.
    return {t * x * x + c,     t * x * y - s * z, t * x * z + s * y,  //
            t * x * y + s * z, t * y * y + c,     t * y * z - s * x,  //
            t * x * z - s * y, t * y * z + s * x, t * z * z + c};
}

std::array<double, 4> quaternion_about(const Vec3& unit_axis, double degrees) {
    const double half = degrees * kDegree / 2, s = std::sin(half);
    return {s * unit_axis[0], s * unit_axis[1], s * unit_axis[2], std::cos(half)};
}

void StatedTransform::rotate(const Vec3& unit_axis, float degrees) {
    const Rotation turn = rotation_about(unit_axis, double{degrees});
    Rotation product{};
    for (size_t row = 0; row < 3; ++row) {
        for (size_t column = 0; column < 3; ++column) {
            for (size_t k = 0; k < 3; ++k) product[3 * row + column] += turn[3 * row + k] * rotation_[3 * k + column];
        }
    }
    rotation_ = product;
    const std::array<double, 4> a = quaternion_about(unit_axis, double{degrees}), b = quaternion_;
    quaternion_ = {a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1], a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
                   a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
                   a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]};
}

std::array<float, 12> StatedTransform::world_from_object() const {
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
