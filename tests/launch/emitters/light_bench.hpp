// light_bench.hpp -- runs the drawing of lights by itself: a kernel draws a light from a point, tests whether something is in
// the way, and tells what a ray in the same direction finds.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/vec.hpp"
#include "support/generated.hpp"

namespace clarity::test {

// What one draw gave, and what the ray in its direction found.
struct LightDraw {
    std::array<float, 3> towards, light;  // light: radiance / density
    float distance, pdf;
    bool valid, delta, occluded;
    int number;  // of the light
    std::array<float, 3> found;
    float found_pdf, found_distance;
};

// Three numbers of [0, 1) for each sample: the pick, and two for the direction.
using Numbers = std::vector<std::array<float, 3>>;
// Points that fill the cube evenly: the R3 sequence, shifted by `seed` (Roberts 2018).
Numbers even_numbers(size_t count, unsigned seed);
// Numbers of a random generator.
Numbers random_numbers(size_t count, unsigned seed);

class LightBench {
 public:
    // tree: lights are picked by a light tree.
    LightBench(const Scene& scene, const View& view, int lanes = 8, bool tree = false);
    ~LightBench();
    // Draws lights from a point. normal: of the surface there, for the light tree; 0, 0, 0: it is lit from both sides.
    std::vector<LightDraw> draw(const Point& at, const Numbers& numbers, const Vec& normal = {});
    // Does not draw, but sends rays in directions that fill the sphere evenly, by the second and third number; `pdf` is 0.
    std::vector<LightDraw> find(const Point& at, const Numbers& numbers, const Vec& normal = {});
    // With which probability each emitter is picked at a point, by its number.
    std::vector<float> chances(const Point& at, const Vec& normal);
    // The irradiance at a point with a normal: the mean of what draws bring, in red. error: its standard error.
    double irradiance(const Point& at, const Vec& normal, const Numbers& numbers, double* error = nullptr);
    // The same by rays in all directions.
    double irradiance_by_rays(const Point& at, const Vec& normal, const Numbers& numbers);

 private:
    std::vector<LightDraw> run(const Point& at, const Numbers& numbers, const Vec& normal, bool draws);
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

// A scene without anything but a default material, and a view without lights and sky.
Scene empty_scene();
View dark_view();
// Lights, in radiance or with falloff.
rt_light rect_light(const Point& center, const Point& u, const Point& v, float radiance);
rt_light disc_light(const Point& center, const Point& normal, float radius, float radiance);
rt_light sphere_light(const Point& center, float radius, float radiance);
rt_light sun_light(const Point& towards, double full_angle_deg, float irradiance);
rt_light far_light(const Point& towards, float irradiance);
rt_light point_light(const Point& at, float intensity);
rt_light spot_light(const Point& at, const Point& axis, float intensity, double inner_deg, double outer_deg);

}  // namespace clarity::test
