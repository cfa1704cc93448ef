// path_light_tree_test.cpp -- pictures whose lights are picked by a light tree have the mean of those by the table.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "images/path_checks.hpp"
#include "support/planted_faults.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

rt_material surface(rt_u32 model, float color) {
    rt_material m = diffuse(color, color, color);
    m.model = model;
    return m;
}

// A floor and a box that glows, balls of metal, of frosted glass and of chalk, a sky, and 50 lamps of the kinds that fall off,
// half of them below the floor.
Scene many_lights() {
    Scene scene = scene_of(box(0.5));
    rt_material glow = surface(RT_MODEL_LAMBERT, 0.5f), metal = surface(RT_MODEL_CONDUCTOR, 0.8f), frosted = glass(1.5f);
    glow.emission[0] = glow.emission[1] = glow.emission[2] = 3;
    metal.roughness = 0.5f;
    frosted.model = RT_MODEL_DIELECTRIC;
    frosted.roughness = 0.4f;
    scene.materials[0].values = glow;
    const rt_u32 of_balls[] = {add_material(scene, metal), add_material(scene, frosted),
                               add_material(scene, surface(RT_MODEL_LAMBERT, 0.7f))};
    for (int i = 0; i < 3; ++i) {
        Sphere ball;
        ball.center = {-2.5f + 2.5f * float(i), 0.3f, 1.8f};
        ball.radius = 0.7f;
        ball.material = of_balls[i];
        scene.spheres.push_back(ball);
    }
    scene.planes.push_back({{0, 1, 0}, -0.6f, add_material(scene, surface(RT_MODEL_LAMBERT, 0.6f))});
    return scene;
}

View view_of_many() {
    View view = view_from({0.5f, 2.5f, 7}, {0, 0, 0}, 45);
    view.background = {0.05f, 0.05f, 0.08f};
    for (int i = 0; i < 50; ++i) {
        rt_light light{};
        const rt_u32 kinds[] = {RT_LIGHT_POINT, RT_LIGHT_SPHERE, RT_LIGHT_DISC, RT_LIGHT_SPOT};
        light.kind = kinds[i / 2 % 4];
        light.flags = RT_LIGHT_FALLOFF;
        light.position[0] = -6 + 1.3f * float(i % 10);
        light.position[1] = i % 2 == 0 ? 0.2f + 0.4f * float(i % 3) : -1.5f;
        light.position[2] = -4 + 1.7f * float(i / 10);
        light.normal[1] = i % 3 > 0 ? -1 : 1;
        light.radius = 0.1f;
        light.cos_inner = 0.9f;
        light.cos_outer = 0.5f;
        const float color = light.kind == RT_LIGHT_SPHERE || light.kind == RT_LIGHT_DISC ? 12.0f : 0.4f;
        for (float& c : light.color) c = color;
        view.lights.push_back(light);
    }
    return view;
}

PathPicture traced(const std::string& strategy, const std::string& pick, const char* depth = "3") {
    return trace_paths(many_lights(), view_of_many(), 64,
                       {{"depth", depth},
                        {"sampler", "independent"},
                        {"strategy", strategy},
                        {"light_sampling", pick},
                        {"seed", pick == "tree" ? "1" : "2"}});
}

// The largest difference of two pictures in blocks of 8x8 pixels, in standard errors of their luminance.
double worst_block(const PathPicture& a, const PathPicture& b) {
    double worst = 0;
    for (size_t block = 0; block < 64; ++block) {
        double difference = 0, variance = 0;
        for (size_t i = 0; i < 64; ++i) {
            const size_t pixel = (block / 8 * 8 + i / 8) * 64 + block % 8 * 8 + i % 8;
            const double weights[] = {0.2126, 0.7152, 0.0722};
            for (size_t k = 0; k < 3; ++k)
                difference += weights[k] * (double(a.mean.pixels[3 * pixel + k]) - double(b.mean.pixels[3 * pixel + k]));
            variance += std::pow(double(a.error.pixels[pixel]), 2) + std::pow(double(b.error.pixels[pixel]), 2);
        }
        worst = std::max(worst, std::fabs(difference) / std::sqrt(variance));
    }
    return worst;
}

// Of the standard errors of pixels. The mean would be that of a few pixels in caustics.
float median(const FloatImage& error) {
    auto all = error.pixels;
    std::nth_element(all.begin(), all.begin() + 2048, all.end());
    return all[2048];
}

// 128 blocks: one is beyond 4.5 standard errors by chance in 1,000 runs.
TEST(PathLightTree, HasTheMeanOfTheTable) {
    for (const char* strategy : {"mis", "nee"})
        EXPECT_LT(worst_block(traced(strategy, "table"), traced(strategy, "tree")), 4.5) << strategy;
}

TEST(PathLightTree, HasLessNoise) {
    EXPECT_LT(median(traced("mis", "tree").error), 0.7f * median(traced("mis", "table").error));
}

// What a ray finds must be weighted with the chance that the tree gives it.
TEST(PathLightTree, AWrongDensityIsFound) {
    const PathPicture table = traced("mis", "table", "1");
    const FaultyKernel planted("shading/emission.h", "pick[l] = rt_pick_of(ctx, e, &point);",
                               "pick[l] = e->pick + 0.0f * point.at[0];");
    EXPECT_GT(worst_block(table, traced("mis", "tree", "1")), 8);
}

}  // namespace
