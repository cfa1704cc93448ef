// path_media_test.cpp -- solids within solids: `path` knows what is around a ray when it leaves the inner one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "images/path_checks.hpp"
#include "support/planted_faults.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

rt_material absorbing(float ior, std::array<float, 3> absorption) {
    rt_material m = diffuse(1, 1, 1);
    m.model = RT_MODEL_DIELECTRIC;
    m.ior = ior;
    std::copy(absorption.begin(), absorption.end(), m.absorption);
    return m;
}

// A slab from z = -half to half, wide enough for all rays.
void add_slab(Scene& scene, float half, const rt_material& material) {
    Instance slab;
    slab.mesh = 0;
    slab.world_from_object = {10, 0, 0, 0, 0, 10, 0, 0, 0, 0, half, 0};
    slab.material = add_material(scene, material);
    scene.instances.push_back(slab);
}

// Slabs in each other, the outermost first, seen by rays along z. A wall behind them emits 1.
PathPicture slabs(const std::vector<std::pair<float, rt_material>>& solids, unsigned samples) {
    Scene scene = scene_of(box(1));
    scene.instances.clear();
    for (const auto& [half, material] : solids) add_slab(scene, half, material);
    rt_material wall = diffuse(0, 0, 0);
    for (float& e : wall.emission) e = 1;
    scene.planes.push_back({{0, 0, 1}, -20, add_material(scene, wall)});
    View view = view_from({0.3f, 0.2f, 15}, {0.3f, 0.2f, 0}, 0.2);
    view.background = {0, 0, 0};
    return trace_paths(scene, view, samples, {{"size", "16x16"}, {"depth", "40"}, {"sampler", "independent"}});
}

// Beer-Lambert: exp of minus absorption times the way in each. Nothing is bent or reflected.
TEST(PathMedia, AreRestoredWhenTheInnerSolidIsLeft) {
    const rt_material water = absorbing(1, {0.1f, 0.2f, 0.05f}), oil = absorbing(1, {0.3f, 0.02f, 0.1f}),
                      glass = absorbing(1, {0.05f, 0.4f, 0});
    const PathPicture picture = slabs({{3, water}, {2, oil}, {0.5f, glass}}, 256);
    // Of green. What is left at last decides by roulette.
    EXPECT_NEAR(picture.average(), std::exp(-2 * 0.2 - 3 * 0.02 - 1 * 0.4), 4 * picture.average_error() + 1e-4);
    EXPECT_LT(picture.average_error(), 3e-3);
}

// The boundary of glass in water reflects by the ratio of both: 0.36 % instead of 4 %. Of plates without absorption the share
// that comes through is 1 / (1 + sum of R / (1 - R)).
TEST(PathMedia, TheRatioOfIndicesIsThatOfBothSides) {
    const PathPicture picture = slabs({{3, absorbing(1.33f, {})}, {1, absorbing(1.5f, {})}}, 1024);
    const auto boundary = [](double a, double b) {
        const double r = (a - b) * (a - b) / ((a + b) * (a + b));
        return r / (1 - r);
    };
    const double wanted = 1 / (1 + 2 * boundary(1, 1.33) + 2 * boundary(1.33, 1.5));
    EXPECT_NEAR(picture.average(), wanted, 4 * picture.average_error() + 1e-4);
    EXPECT_LT(picture.average_error(), 1e-3);
}

// One more than the path remembers: then the outermost is forgotten, and only its last stretch is wrong.
TEST(PathMedia, FourSolidsAreRemembered) {
    for (const int count : {4, 5}) {
        std::vector<std::pair<float, rt_material>> solids;
        for (int i = 0; i < count; ++i) solids.emplace_back(float(count - i), absorbing(1, {0.1f, 0.1f, 0.1f}));
        const PathPicture picture = slabs(solids, 256);
        // Of five, a last stretch of length 1 is not counted.
        EXPECT_NEAR(picture.average(), std::exp(count == 4 ? -0.8 : -0.9), 4 * picture.average_error() + 1e-4) << count;
        EXPECT_LT(picture.average_error(), 3e-3);
    }
}

// Samples of `path` that are not finite are counted, and their pixels show it.

struct Traced {
    uint64_t counted = 0;
    size_t broken_pixels = 0;
};

Traced trace(int lanes) {
    const Settings settings = make_settings(
        {{"tracer", "path"}, {"lanes", std::to_string(lanes)}, {"packet", "8x8"}, {"size", "32x24"}, {"depth", "2"}});
    const ScenePtr scene = shared_scene(sphere_over_floor());
    Workbench& bench = Workbench::get();
    Progress progress;
    Traced traced;
    traced.counted =
        bench.frames()
            .trace(*bench.prepare(scene, settings, floor_view()), settings, floor_view(), Samples(0, 8), true, progress)
            .not_finite;
    const FloatImage image = bench.frames().read_values();
    for (size_t i = 0; i < image.pixels.size(); i += 3) traced.broken_pixels += !std::isfinite(image.pixels[i + 1]);
    return traced;
}

TEST(PathNotFinite, SamplesAreCountedAndNotHidden) {
    for (const int lanes : {1, 4, 8}) {
        EXPECT_EQ(trace(lanes).counted, 0u) << lanes << " lanes";
        // Two samples of each of three pixels are no number.
        const FaultyKernel planted(
            "tracers/path/state.h", "rt_store_lanes(p->light, 1.0f, light);",
            "rt_store_lanes(p->light, 1.0f, light); { int at[RT_LANES], of[RT_LANES]; rt_store(p->pixel, at); "
            "rt_store(p->sample, of); for (uint l = 0; l < RT_LANES; ++l) if ((at[l] == 5 || at[l] == 300 || "
            "at[l] == 767) && (of[l] == 2 || of[l] == 7)) light[l].y = as_float(0x7fc00000); }");
        const Traced broken = trace(lanes);
        EXPECT_EQ(broken.counted, 6u) << lanes << " lanes";
        EXPECT_EQ(broken.broken_pixels, 3u) << lanes << " lanes";
    }
}

// Pictures whose lights are picked by a light tree have the mean of those by the table.

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
    const PathPicture table = quick() ? PathPicture() : traced("mis", "table", "1");
    const FaultyKernel planted("shading/emission.h", "pick[l] = rt_pick_of(ctx, e, &point);",
                               "pick[l] = e->pick + 0.0f * point.at[0];");
    if (quick()) return;  // the text is there
    EXPECT_GT(worst_block(table, traced("mis", "tree", "1")), 8);
}

}  // namespace
