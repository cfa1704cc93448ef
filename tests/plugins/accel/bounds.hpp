// bounds.hpp -- boxes in double precision, for checks of trees.
#pragma once
#include <algorithm>
#include <cmath>

namespace accel_test {

struct Bounds {
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    void add(const float* l, const float* h) {
        for (int a = 0; a < 3; ++a) {
            lo[a] = std::min<double>(lo[a], l[a]);
            hi[a] = std::max<double>(hi[a], h[a]);
        }
    }
    double area() const {
        const double x = hi[0] - lo[0], y = hi[1] - lo[1], z = hi[2] - lo[2];
        return 2 * (x * y + y * z + z * x);
    }
    double longest() const { return std::max({hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]}); }
};

}  // namespace accel_test
