// path_media_test.cpp -- solids within solids: `path` knows what is around a ray when it leaves the inner one.
#include <gtest/gtest.h>

#include <cmath>

#include "images/path_checks.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

rt_material solid(float ior, std::array<float, 3> absorption) {
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
    const rt_material water = solid(1, {0.1f, 0.2f, 0.05f}), oil = solid(1, {0.3f, 0.02f, 0.1f}),
                      glass = solid(1, {0.05f, 0.4f, 0});
    const PathPicture picture = slabs({{3, water}, {2, oil}, {0.5f, glass}}, 256);
    // Of green. What is left at last decides by roulette.
    EXPECT_NEAR(picture.average(), std::exp(-2 * 0.2 - 3 * 0.02 - 1 * 0.4), 4 * picture.average_error() + 1e-4);
    EXPECT_LT(picture.average_error(), 3e-3);
}

// The boundary of glass in water reflects by the ratio of both: 0.36 % instead of 4 %. Of plates without absorption the share
// that comes through is 1 / (1 + sum of R / (1 - R)).
TEST(PathMedia, TheRatioOfIndicesIsThatOfBothSides) {
    const PathPicture picture = slabs({{3, solid(1.33f, {})}, {1, solid(1.5f, {})}}, 1024);
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
        for (int i = 0; i < count; ++i) solids.emplace_back(float(count - i), solid(1, {0.1f, 0.1f, 0.1f}));
        const PathPicture picture = slabs(solids, 256);
        // Of five, a last stretch of length 1 is not counted.
        EXPECT_NEAR(picture.average(), std::exp(count == 4 ? -0.8 : -0.9), 4 * picture.average_error() + 1e-4) << count;
        EXPECT_LT(picture.average_error(), 3e-3);
    }
}

}  // namespace
