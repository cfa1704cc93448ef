// path_checks.hpp -- what the tracer `path` must show, as checks that tests run on the sound kernels and on faulty ones.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "support/generated.hpp"

namespace clarity::test {

using Pairs = std::vector<std::pair<std::string, std::string>>;

// A picture by `path` with its noise. Settings are what compiles fast, 64x64 pixels, and those given.
struct PathPicture {
    FloatImage mean, error;  // 3 channels; standard error of the mean luminance
    double average() const;  // of green, over pixels
    // Standard deviation of the pixels' averages, and of their average.
    double deviation() const;
    double average_error() const;
};
PathPicture trace_paths(const Scene& scene, const View& view, unsigned samples, const Pairs& settings);

// The inside of a sphere of radius 1 that emits 1 and reflects `albedo`, or is lit by a point light of intensity 1 in its
// middle. What a pixel shows is in closed form for every depth.
Scene hollow_sphere(float albedo, float emission);
View inside_view(bool with_light);
double hollow_sphere_radiance(double albedo, int depth);  // emitting
double lit_sphere_radiance(double albedo, int depth);     // with the light

// A white floor below an emitting sphere. All pixels show one point, whose radiance is in closed form.
Scene sphere_over_floor();
View floor_view();
constexpr double kFloorRadiance = 0.20410496026731736;  // 1.5 / sqrt(3.78)^3, of a sphere of radius 1 at (1.2, 1.5, 0.3)

// What is wrong of the tracer with the kernels in force, a word for each: "depth", "last event", "roulette", "cosine",
// "directions", "noise", "glass", "facets". Empty of sound ones. only: that check alone.
std::vector<std::string> path_problems(int seed, const std::string& only = {});

}  // namespace clarity::test
