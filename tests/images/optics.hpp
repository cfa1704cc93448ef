// optics.hpp -- expected pictures, computed from formulas in double precision.
#pragma once
#include <array>
#include <functional>

#include "scene/vec.hpp"
#include "support/generated.hpp"

namespace clarity::test {

// A ray of the formulas.
struct Line {
    Vec origin, direction;  // direction has unit length
    Vec at(double t) const { return origin + t * direction; }
};
// The line through the centre of a pixel; y = 0 is the top row.
Line pixel_line(const Camera& camera, int width, int height, int x, int y);
// Distance to the sphere; +inf if it is missed. margin: distance of the line from the silhouette, in radii.
double meet_sphere(const Line& line, const Vec& center, double radius, double* margin = nullptr);

// Snell's and Fresnel's laws for unpolarised light. eta: index on this side / index on the other side. fresnel() returns 1 for
// total internal reflection.
double fresnel(double cos_in, double eta);
Vec refracted(const Vec& direction, const Vec& normal_towards, double eta);

// A traced picture with linear colours, and the statistics of its frame.
struct Picture {
    int width, height;
    FloatImage image;
    FrameStats stats;
    std::array<float, 3> at(int x, int y) const;
};
Picture trace(const Scene& scene, const View& view, int width, int height, int depth,
              const std::vector<std::pair<std::string, std::string>>& settings = {});

// Compares the green channel of every pixel with `expected`. A negative expectation leaves the pixel out, because it is too
// close to an edge. Reports the worst pixel if it is off by more than `tolerance`. At least `least` pixels must be compared.
void expect_picture(const Picture& picture, const View& view, const std::function<double(const Line&)>& expected,
                    double tolerance, size_t least);

}  // namespace clarity::test
