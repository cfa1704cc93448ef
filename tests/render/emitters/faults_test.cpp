// faults_test.cpp -- the tests of lights find faults: each is planted into the text of a kernel, and the numbers of a closed
// form go wrong by more than a test would pass.
#include <gtest/gtest.h>

#include <cmath>

#include "base/angle.hpp"
#include "render/emitters/light_bench.hpp"
#include "support/planted_faults.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

double light_of(const rt_light& light) {
    View view = dark_view();
    view.lights = {light};
    LightBench bench(empty_scene(), view);
    return bench.irradiance({0.5f, 0, 0}, {0, 1, 0}, even_numbers(1 << 14, 1));
}

TEST(PlantedFaults, OfLightsAreFound) {
    const rt_light square = rect_light({0, 1, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}, 1), sun = sun_light({0, 1, 0}, 0.533, 1);
    const double of_square = kPi * 0.180369;
    const auto light_with = [](const char* from, const char* to, const rt_light& light) {
        const FaultyKernel planted("shading/emitters.h", from, to);
        return light_of(light);
    };
    const char* const density = "return distance2 / (area * cosine);";
    EXPECT_NEAR(light_of(square) / of_square, 1, 0.005) << "sound";
    EXPECT_NEAR(light_of(sun), 1, 0.005) << "sound";
    EXPECT_GT(std::fabs(light_with(density, "return rt_vfloat(1.0f) / (area * cosine);", square) / of_square - 1), 0.02)
        << "light pdf without distance^2";
    EXPECT_GT(std::fabs(light_with(density, "return distance2 / area;", square) / of_square - 1), 0.02)
        << "light pdf without cosine";
    EXPECT_GT(std::fabs(light_with("return rt_vfloat(2.0f * RT_PI) * versine;", "return rt_vfloat(RT_PI) * versine;", sun) - 1),
              0.02)
        << "sun solid angle off by 2";
}

// A lobe towards a corner of the horizon, where both faults show.
TEST(PlantedFaults, OfSkiesAreFound) {
    Scene scene = empty_scene();
    SkyValues& sky = scene.sky.values;
    sky.kind = RT_SKY_PICTURE;
    sky.width = 32;
    sky.height = 16;
    std::vector<float> texels(3 * 32 * 16, 0.1f);
    for (int k = 0; k < 3; ++k) texels[size_t(3 * (4 * 32 + 16) + k)] = 100;
    scene.sky.texels = texels;
    // Its middle: azimuth and angle to the zenith of texel (16, 4).
    const double phi = 2 * kPi * (16.5 / 32 - 0.5), theta = kPi * 4.5 / 16;
    const Vec middle = {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
    const auto errors = [&] {
        LightBench bench(scene, dark_view());
        const double by_draws = bench.irradiance({0, 0, 0}, {0, 1, 0}, even_numbers(1 << 15, 1)),
                     by_rays = bench.irradiance_by_rays({0, 0, 0}, {0, 1, 0}, even_numbers(1 << 18, 1));
        Vec mean{};
        for (const LightDraw& ray : bench.find({0, 0, 0}, even_numbers(1 << 18, 1))) {
            const double light = std::max(0.f, ray.found[0] - 0.1f);
            mean = mean + light * to_vec(ray.towards);
        }
        return std::pair(std::fabs(by_draws / by_rays - 1), length(normalized(mean) - middle));
    };
    const auto errors_with = [&](const char* from, const char* to) {
        const FaultyKernel planted("shading/sky.h", from, to);
        return errors();
    };
    const auto [sound_light, sound_place] = errors();
    EXPECT_LT(sound_light, 0.01) << "sound";
    EXPECT_LT(sound_place, 0.01) << "sound";
    EXPECT_GT(errors_with("rt_max(sine, rt_vfloat(1e-9f))", "rt_vfloat(1.0f)").first, 0.05) << "env sin(theta) missing";
    EXPECT_GT(errors_with("x = fma(u, rt_vfloat((float)w), rt_vfloat(-0.5f))", "x = u * rt_vfloat((float)w)").second, 0.05)
        << "env shifted by half a texel";
}

// On a wall, which sees both halves of a gradient.
TEST(PlantedFaults, OfGradientsAreFound) {
    Scene scene = empty_scene();
    SkyValues& sky = scene.sky.values;
    sky.kind = RT_SKY_GRADIENT;
    for (int k = 0; k < 3; ++k) sky.color[k] = 1, sky.horizon[k] = 0.2f, sky.ground[k] = 0.4f;
    const auto error = [&] {
        LightBench bench(scene, dark_view());
        return std::fabs(bench.irradiance({0, 0, 0}, {1, 0, 0}, even_numbers(1 << 15, 1)) /
                             bench.irradiance_by_rays({0, 0, 0}, {1, 0, 0}, even_numbers(1 << 18, 1)) -
                         1);
    };
    const auto error_with = [&](const char* from, const char* to) {
        const FaultyKernel planted("shading/sky.h", from, to);
        return error();
    };
    EXPECT_LT(error(), 0.005) << "sound";
    EXPECT_GT(error_with("rt_vfloat(1.0f - below) * rt_gradient_shape", "rt_gradient_shape"), 0.02)
        << "density without the share of the part above";
    EXPECT_GT(error_with("fma(y, rt_vfloat(1.0f - 2.0f * horizon), rt_vfloat(horizon))",
                         "fma(y, rt_vfloat(2.0f * horizon - 1.0f), rt_vfloat(1.0f - horizon))"),
              0.02)
        << "horizon and zenith change places";
    EXPECT_GT(error_with("height = v / rt_max(", "height = v; (void)rt_max("), 0.02) << "drawn evenly above";
}

}  // namespace
