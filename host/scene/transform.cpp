// transform.cpp -- affine maps.
#include <cmath>

#include "scene/scene.hpp"

namespace clarity {

std::array<float, 3> transform_point(const Affine& m, const float* p) {
    std::array<float, 3> r{};
    for (int i = 0; i < 3; ++i) {
        const float* row = &m[4 * i];
        r[i] = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
    }
    return r;
}

Affine multiply(const Affine& a, const Affine& b) {
    Affine r{};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 4; ++j) {
            double sum = j == 3 ? a[4 * i + 3] : 0.0;
            for (int k = 0; k < 3; ++k) sum += double(a[4 * i + k]) * b[4 * k + j];
            r[4 * i + j] = static_cast<float>(sum);
        }
    }
    return r;
}

bool invert(const Affine& m, Affine& inverse) {
    const double a[9] = {m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]};
    const double cofactor[9] = {a[4] * a[8] - a[5] * a[7], a[2] * a[7] - a[1] * a[8], a[1] * a[5] - a[2] * a[4],
                                a[5] * a[6] - a[3] * a[8], a[0] * a[8] - a[2] * a[6], a[2] * a[3] - a[0] * a[5],
                                a[3] * a[7] - a[4] * a[6], a[1] * a[6] - a[0] * a[7], a[0] * a[4] - a[1] * a[3]};
    const double determinant = a[0] * cofactor[0] + a[1] * cofactor[3] + a[2] * cofactor[6];
    // Compare the determinant with the product of the column lengths: a model in micrometres has a tiny determinant without
    // being singular.
    double lengths = 1;
    for (int j = 0; j < 3; ++j) lengths *= std::sqrt(a[j] * a[j] + a[3 + j] * a[3 + j] + a[6 + j] * a[6 + j]);
    if (!(std::abs(determinant) > 1e-7 * lengths)) return false;
    Affine r{};
    for (int i = 0; i < 3; ++i) {
        double translation = 0;
        for (int j = 0; j < 3; ++j) {
            const double value = cofactor[3 * i + j] / determinant;
            r[4 * i + j] = static_cast<float>(value);
            translation -= value * m[4 * j + 3];
        }
        r[4 * i + 3] = static_cast<float>(translation);
    }
    for (const float value : r) {
        if (!std::isfinite(value)) return false;
    }
    inverse = r;
    return true;
}

}  // namespace clarity
