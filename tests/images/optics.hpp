// optics.hpp -- what pictures should show, by formula and in double precision.
#pragma once
#include <array>
#include <functional>

#include "support/generated.hpp"

namespace clarity::test {

using Vec = std::array<double, 3>;
Vec operator+(const Vec& a, const Vec& b);
Vec operator-(const Vec& a, const Vec& b);
Vec operator*(double s, const Vec& a);
double dot(const Vec& a, const Vec& b);
Vec normalized(const Vec& a);

struct Line {
    Vec origin, direction;  // unit
    Vec at(double t) const { return origin + t * direction; }
};
// Through the centre of a pixel; y = 0 at the top.
Line pixel_line(const Camera& camera, int width, int height, int x, int y);
// Distance, +inf if missed, and how far from the silhouette the line passes, in radii.
double meet_sphere(const Line& line, const Vec& center, double radius, double* margin = nullptr);

// Snell and Fresnel for unpolarised light; eta = index on this side / index on the other. 1 for total internal reflection.
double fresnel(double cos_in, double eta);
Vec refracted(const Vec& direction, const Vec& normal_towards, double eta);

// A picture of a scene whose settings are its own; colours are linear.
struct Picture {
    int width, height;
    FloatImage image;
    FrameStats stats;
    std::array<float, 3> at(int x, int y) const;
};
Picture trace(const Scene& scene, const View& view, int width, int height, int depth,
              const std::vector<std::pair<std::string, std::string>>& settings = {});

// Compares every pixel's green with what `expected` says of it; a negative answer leaves the pixel out (too near to an edge).
// Fails with the worst pixel; at least `least` pixels must have been compared.
void expect_picture(const Picture& picture, const View& view, const std::function<double(const Line&)>& expected,
                    double tolerance, size_t least);

}  // namespace clarity::test
