#include "scene/motion/dual_quaternion.hpp"

#include <cmath>

namespace clarity {

DualQuaternion dual_quaternion(const Matrix& m) {
    Matrix turn = m;
    DualQuaternion d;
    for (int j = 0; j < 3; ++j) {
        double length = std::sqrt(m[j] * m[j] + m[4 + j] * m[4 + j] + m[8 + j] * m[8 + j]);
        if (j == 2 && determinant(m) < 0) length = -length;
        d.scale[j] = length;
        for (int i = 0; i < 3; ++i) turn[4 * i + j] = length != 0 ? m[4 * i + j] / length : (i == j ? 1 : 0);
    }
    d.real = quaternion_of(turn);
    d.dual = Quaternion{m[3], m[7], m[11], 0} * d.real;
    for (double& x : d.dual) x *= 0.5;
    return d;
}

void add(DualQuaternion& sum, const DualQuaternion& d, double weight) {
    double cosine = 0;
    for (int i = 0; i < 4; ++i) cosine += sum.real[i] * d.real[i];
    const double w = cosine < 0 ? -weight : weight;  // q and -q are the same rotation
    for (int i = 0; i < 4; ++i) {
        sum.real[i] += w * d.real[i];
        sum.dual[i] += w * d.dual[i];
    }
    for (int i = 0; i < 3; ++i) sum.scale[i] += weight * d.scale[i];
}

Matrix matrix_of(const DualQuaternion& sum) {
    double length = 0;
    for (const double x : sum.real) length += x * x;
    length = std::sqrt(length);
    if (!(length > 0)) return kIdentityMatrix;
    Quaternion real = sum.real, dual = sum.dual;
    for (double& x : real) x /= length;
    for (double& x : dual) x /= length;
    const Quaternion moved = dual * Quaternion{-real[0], -real[1], -real[2], real[3]};
    Matrix m = rotation(real) * scaling(sum.scale);
    for (int i = 0; i < 3; ++i) m[4 * i + 3] = 2 * moved[i];
    return m;
}

}  // namespace clarity
