// faults_test.cpp -- the tests of lights find faults: each is planted into the kernel by a define, and the numbers of a closed
// form go wrong by more than a test would pass.
#include <gtest/gtest.h>

#include <cmath>

#include "base/angle.hpp"
#include "render/emitters/light_bench.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

double light_of(const rt_light& light, const std::vector<std::string>& defines) {
    View view = dark_view();
    view.lights = {light};
    LightBench bench(empty_scene(), view, 8, defines);
    return bench.irradiance({0.5f, 0, 0}, {0, 1, 0}, even_numbers(1 << 14, 1));
}

TEST(PlantedFaults, OfLightsAreFound) {
    const rt_light square = rect_light({0, 1, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}, 1), sun = sun_light({0, 1, 0}, 0.533, 1);
    const double of_square = kPi * 0.180369;
    EXPECT_NEAR(light_of(square, {}) / of_square, 1, 0.005) << "sound";
    EXPECT_NEAR(light_of(sun, {}), 1, 0.005) << "sound";
    EXPECT_GT(std::fabs(light_of(square, {"RT_FAULT_5"}) / of_square - 1), 0.02) << "light pdf without distance^2";
    EXPECT_GT(std::fabs(light_of(square, {"RT_FAULT_6"}) / of_square - 1), 0.02) << "light pdf without cosine";
    EXPECT_GT(std::fabs(light_of(sun, {"RT_FAULT_9"}) - 1), 0.02) << "sun solid angle off by 2";
}

}  // namespace
