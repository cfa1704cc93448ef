// wavefront_test.cpp -- the tracer `wavefront` gives the same pictures and counts as `iterative`, in whatever order its
// work-groups run and however small its queues are.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "support/generated.hpp"
#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

struct Traced {
    FloatImage values, distance;
    FrameStats stats;
};

Traced trace(const ScenePtr& scene, const View& view, Settings settings, const std::string& tracer, unsigned samples = 1) {
    settings.tracer = tracer;
    Traced traced;
    for (unsigned sample = 0; sample < samples; ++sample) traced.stats = bench().trace(scene, settings, view, sample);
    traced.values = bench().frames().read_values();
    traced.distance = bench().frames().read_distance();
    return traced;
}

size_t different_bits(const FloatImage& a, const FloatImage& b) {
    if (a.pixels.empty() || a.pixels.size() != b.pixels.size()) return std::max<size_t>(a.pixels.size() + b.pixels.size(), 1);
    size_t count = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) count += std::memcmp(&a.pixels[i], &b.pixels[i], sizeof(float)) != 0;
    return count;
}

void expect_same_counts(const FrameStats& a, const FrameStats& b, const std::string& what) {
    EXPECT_EQ(a.shadow, b.shadow) << what;
    EXPECT_EQ(a.secondary, b.secondary) << what;
    EXPECT_EQ(a.dropped, b.dropped) << what;
    EXPECT_EQ(a.overflowed, b.overflowed) << what;
}

// With `portable`, one lane runs what a GPU without shuffles runs: work-groups of 64 that communicate through local memory.
struct Way {
    int lanes, packet_w, packet_h;
    bool portable;
    Settings settings(const std::string& size, const std::string& depth) const {
        Settings s = make_settings({{"size", size}, {"depth", depth}, {"debug", "true"}});
        Configuration{"bvh2", lanes, packet_w, packet_h}.apply(s);
        s.portable = portable;
        return s;
    }
    std::string text() const {
        return std::to_string(lanes) + " lanes, packet " + std::to_string(packet_w) + "x" + std::to_string(packet_h) +
               (portable ? ", portable" : "");
    }
};
const Way kGroup{1, 1, 1, true}, kOdd{8, 3, 5, false}, kDefault{16, 4, 4, false};

TEST(Wavefront, EqualsIterativeBitByBitIfNoRaySplits) {
    TriangleMesh mesh = torus(2, 0.7, 48, 24), ball = uv_sphere(0.9, 48, 24);
    ball.transform(1, {0, 0.9, 0});
    mesh.add(ball);
    const ScenePtr scene = shared_scene(scene_of(mesh));
    View view = view_from({0, 4, 5}, {0, 0.3f, 0}, 45);
    view.materials.assign(scene->materials.size(), mirror(0.5f));
    for (const Way& way : {kGroup, kOdd}) {
        const Settings settings = way.settings("161x123", "6");
        const Traced a = trace(scene, view, settings, "iterative", 2), b = trace(scene, view, settings, "wavefront", 2);
        EXPECT_GT(a.stats.secondary, 5000u) << "too few reflections to prove anything";
        EXPECT_EQ(different_bits(a.values, b.values), 0u) << way.text();
        EXPECT_EQ(different_bits(a.distance, b.distance), 0u) << way.text();
        expect_same_counts(a.stats, b.stats, way.text());
    }
}

TEST(Wavefront, EqualsIterativeWithGlass) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    const View view = make_view(*scene, 4.0f / 3);
    for (const Way& way : {kGroup, kDefault}) {
        Settings settings = way.settings("160x120", "8");
        settings.ray_slots = 32;
        const Traced a = trace(scene, view, settings, "iterative", 3), b = trace(scene, view, settings, "wavefront", 3),
                     again = trace(scene, view, settings, "wavefront", 3);
        EXPECT_EQ(a.stats.dropped, 0u);
        size_t differ = 0;
        for (size_t i = 0; i < a.values.pixels.size(); ++i)
            differ += !(std::fabs(a.values.pixels[i] - b.values.pixels[i]) <= 1e-5f * std::max(1.0f, a.values.pixels[i]));
        EXPECT_EQ(differ, 0u) << way.text();
        expect_same_counts(a.stats, b.stats, way.text());
        EXPECT_EQ(different_bits(b.values, again.values), 0u) << way.text() << ": the order of work-groups changes the picture";
    }
}

// With more room for each pixel, fewer pixels fit into a piece.
TEST(Wavefront, PiecesJoinToTheSamePicture) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    const View view = make_view(*scene, 4.0f / 3);
    Settings settings = kDefault.settings("400x300", "5");
    const Traced whole = trace(scene, view, settings, "wavefront");
    settings.ray_slots = 64;
    const Traced pieces = trace(scene, view, settings, "wavefront");
    EXPECT_EQ(different_bits(whole.values, pieces.values), 0u);
    expect_same_counts(whole.stats, pieces.stats, "pieces");
}

// Concentric balls: a ray splits more often than there is room for.
TEST(Wavefront, CountsDroppedRays) {
    Scene balls;
    const rt_u32 material = add_material(balls, glass(2.4f));
    for (int i = 1; i <= 4; ++i) {
        Sphere ball{};
        ball.radius = 0.7f * float(i);
        ball.material = material;
        balls.spheres.push_back(ball);
    }
    balls.background = {1, 1, 1};
    const ScenePtr scene = shared_scene(std::move(balls));
    const View view = view_from({0, 0, 6}, {0, 0, 0}, 20);
    Settings settings = kGroup.settings("64x48", "12");
    set_setting(settings, "min_weight", "2e-3");
    settings.ray_slots = 64;
    const Traced all = trace(scene, view, settings, "wavefront");
    EXPECT_EQ(all.stats.dropped, 0u);
    settings.ray_slots = 1;
    const Traced some = trace(scene, view, settings, "wavefront");
    EXPECT_GT(some.stats.dropped, 0u);
    EXPECT_LT(some.stats.secondary, all.stats.secondary);
    size_t brighter = 0;
    for (size_t i = 0; i < all.values.pixels.size(); ++i) brighter += !(some.values.pixels[i] <= all.values.pixels[i] + 1e-4f);
    EXPECT_EQ(brighter, 0u);
}

TEST(Wavefront, AutoIsIterativeOnACpu) {
    if (!bench().device().info().cpu) GTEST_SKIP() << "SKIPPED: no CPU device";
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    EXPECT_EQ(bench().prepare(scene, make_settings({{"accel", "bvh2"}, {"aov", "t"}}))->settings.tracer, "iterative");
    const Settings asked = make_settings({{"accel", "bvh2"}, {"aov", "t"}, {"tracer", "wavefront"}});
    EXPECT_EQ(bench().prepare(scene, asked)->settings.tracer, "wavefront");
}

}  // namespace
