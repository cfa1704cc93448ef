// optics.hpp -- expected pictures, computed from formulas in double precision.
#pragma once
#include <array>
#include <functional>

#include "reference/primitives.hpp"
#include "support/generated.hpp"

namespace clarity::test {

// A traced picture with linear colours, and the statistics of its frame.
struct Picture {
    int width, height;
    FloatImage image;
    FrameStats stats;
    std::array<float, 3> at(int x, int y) const;
};
Picture trace(const Scene& scene, const View& view, int width, int height, int depth,
              const std::vector<std::pair<std::string, std::string>>& settings = {});

// A white square in the xy plane with corners at (0,0) and (2,2); uv is half of the position.
Scene white_square(const Affine& placed = kIdentity);
// Shows exactly that square, in ambient light of 1 and before black.
View view_of_square();

// Compares the green channel of every pixel with `expected`. A negative expectation leaves the pixel out, because it is too
// close to an edge. Reports the worst pixel if it is off by more than `tolerance`. At least `least` pixels must be compared.
void expect_picture(const Picture& picture, const View& view, const std::function<double(const Ray&)>& expected,
                    double tolerance, size_t least);

}  // namespace clarity::test
