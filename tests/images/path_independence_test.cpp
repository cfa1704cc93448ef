// path_independence_test.cpp -- a picture of `path` is the same bit by bit whatever the packet, the order of rows, the
// structure and the number of samples in a call.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "images/path_checks.hpp"
#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

constexpr int kWidth = 61, kHeight = 43;
constexpr unsigned kSamples = 5;

// Triangles, spheres and a plane, of every model of surfaces, with lamps, a light that glows and a sky.
ScenePtr every_kind() {
    Scene scene = scene_of(box(0.6));
    scene.materials[0].values = mirror(0.5f);
    for (float& c : scene.materials[0].values.color) c = 0.8f;
    rt_material metal = diffuse(0.9f, 0.7f, 0.4f), frosted = glass(1.4f), glow = diffuse(0.5f, 0.5f, 0.5f);
    metal.model = RT_MODEL_CONDUCTOR;
    metal.roughness = 0.5f;
    frosted.model = RT_MODEL_DIELECTRIC;
    frosted.absorption[0] = 0.4f;
    glow.emission[0] = glow.emission[1] = 2;
    const rt_u32 of_spheres[] = {add_material(scene, metal), add_material(scene, frosted), add_material(scene, glass(1.5f)),
                                 add_material(scene, glow)};
    for (int i = 0; i < 4; ++i) {
        Sphere sphere;
        sphere.center = {-2.0f + 1.3f * float(i), 0.1f * float(i), 1.5f};
        sphere.radius = 0.5f;
        sphere.material = of_spheres[i];
        scene.spheres.push_back(sphere);
    }
    scene.planes.push_back({{0, 1, 0}, -0.7f, add_material(scene, diffuse(0.6f, 0.6f, 0.5f))});
    return shared_scene(std::move(scene));
}

View view_of_it() {
    View view = view_from({0.5f, 1.5f, 6}, {0, 0, 0}, 45);
    view.background = {0.3f, 0.4f, 0.5f};
    rt_light light{};
    light.position[0] = 2, light.position[1] = 4, light.position[2] = 3;
    for (float& c : light.color) c = 0.7f;
    view.lights = {light};
    return view;
}

class PathIndependence : public testing::Test {
 protected:
    Settings settings(const Pairs& more) const {
        Pairs all = {{"tracer", "path"}, {"size", "61x43"}, {"depth", "6"},
                     {"lanes", "8"},     {"packet", "8x8"}, {"accel", "bvh2"}};
        all.insert(all.end(), more.begin(), more.end());
        return make_settings(all);
    }
    FloatImage picture(const Pairs& more, unsigned in_a_call = kSamples) {
        const Settings s = settings(more);
        Workbench& bench = Workbench::get();
        Progress progress;
        for (unsigned sample = 0; sample < kSamples; sample += in_a_call)
            bench.frames().trace(*bench.prepare(scene_, s, view_), s, view_,
                                 Samples(sample, std::min(in_a_call, kSamples - sample)), false, progress);
        return bench.frames().read_values();
    }
    const ScenePtr scene_ = every_kind();
    const View view_ = view_of_it();
};

size_t differing_values(const FloatImage& a, const FloatImage& b) {
    size_t count = a.pixels.size() != b.pixels.size();
    for (size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i) count += a.pixels[i] != b.pixels[i];
    return count;
}

TEST_F(PathIndependence, OfPacketStructureAndCalls) {
    const FloatImage one = picture({});
    double light = 0;
    for (const float value : one.pixels) light += value;
    EXPECT_GT(light, 100);
    for (const char* packet : {"4x4", "16x16", "7x3", "1x32"})
        EXPECT_EQ(differing_values(one, picture({{"packet", packet}})), 0u) << packet;
    EXPECT_EQ(differing_values(one, picture({{"accel", "bvh8"}})), 0u) << "another structure";
    for (const unsigned in_a_call : {1u, 2u})
        EXPECT_EQ(differing_values(one, picture({}, in_a_call)), 0u) << in_a_call << " samples in a call";
    EXPECT_GT(differing_values(one, picture({{"seed", "1"}})), one.pixels.size() / 2) << "seeds change nothing";
}

// Rows that are traced in another order and in several calls, as devices and ranks share a picture.
TEST_F(PathIndependence, OfTheOrderOfRows) {
    const Settings s = settings({});
    const FloatImage one = picture({});
    Workbench& bench = Workbench::get();
    const auto prepared = bench.prepare(scene_, s, view_);
    Progress progress;
    SharedRows shared;
    shared.rows.resize(prepared->layout.groups_y(kHeight));
    std::iota(shared.rows.rbegin(), shared.rows.rend(), 0u);
    const std::vector<rt_u32> all = shared.rows;
    FloatImage image{unsigned(kWidth), unsigned(kHeight), 3, {}};
    image.pixels.resize(one.pixels.size());
    FrameRenderer frames(bench.shared_device());
    shared.rows.clear();
    for (const rt_u32 row : all) {
        shared.begin = shared.rows.size();
        shared.rows.push_back(row);
        frames.trace(*prepared, s, view_, Samples(0, 1), false, progress, &shared);
    }
    shared.begin = 0;
    frames.trace(*prepared, s, view_, Samples(1, kSamples - 1), false, progress, &shared);
    frames.read_values(image);
    EXPECT_EQ(differing_values(one, image), 0u);
}

TEST_F(PathIndependence, GoesOnFromItsSums) {
    const FloatImage whole = picture({});
    const Settings s = settings({});
    Workbench& bench = Workbench::get();
    const auto prepared = bench.prepare(scene_, s, view_);
    Progress progress;
    FrameRenderer first(bench.shared_device()), second(bench.shared_device());
    first.trace(*prepared, s, view_, Samples(0, 2), false, progress);
    FloatImage sums{unsigned(kWidth), 2u * kHeight, 4, {}};
    sums.pixels.resize(size_t(kWidth) * kHeight * 8);
    first.read_sums(sums);
    second.write_sums(*prepared, s, sums);
    second.trace(*prepared, s, view_, Samples(2, kSamples - 2), false, progress);
    EXPECT_EQ(differing_values(whole, second.read_values()), 0u);
}

// Scenes with shapes of plugins, polygons, textures and instances. Of each, all that is compiled fits together.
TEST(PathScenes, AllAreTraced) {
    for (const char* name : {"scenes/shapes.scene", "scenes/primitives.scene", "scenes/showpiece.scene"}) {
        const ScenePtr scene = load_scene(source_file(name));
        const Settings s = make_settings({{"tracer", "path"}, {"size", "48x36"}, {"depth", "4"}, {"accel", "bvh4"}});
        Workbench& bench = Workbench::get();
        Progress progress;
        bench.frames().trace(*bench.prepare(scene, s), s, make_view(*scene, 4.0f / 3), Samples(0, 4), false, progress);
        double sum = 0;
        size_t lit = 0;
        for (const float value : bench.frames().read_values().pixels) sum += value, lit += value > 0;
        EXPECT_TRUE(std::isfinite(sum)) << name;
        EXPECT_GT(lit, size_t(48 * 36 * 3 / 2)) << name << ": most of it is lit, or shows the background";
    }
}

// Lanes and devices may differ in last bits, which change where a path goes; the mean stays.
TEST_F(PathIndependence, MeansOfAllLaneCountsAgree) {
    const auto mean = [&](const char* lanes) {
        const Settings s = settings({{"lanes", lanes}, {"packet", "4x4"}});
        Workbench& bench = Workbench::get();
        Progress progress;
        bench.frames().trace(*bench.prepare(scene_, s, view_), s, view_, Samples(0, 16), false, progress);
        const FloatImage values = bench.frames().read_values();
        return std::accumulate(values.pixels.begin(), values.pixels.end(), 0.0) / double(values.pixels.size());
    };
    const double eight = mean("8");
    for (const int lanes : lane_counts()) EXPECT_NEAR(mean(std::to_string(lanes).c_str()), eight, 2e-3 * eight) << lanes;
}

}  // namespace
