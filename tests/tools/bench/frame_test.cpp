// frame_test.cpp -- the baselines' frame is the same picture of the same rays as ours; otherwise comparing times would mean
// nothing.
#include <gtest/gtest.h>

#include <cmath>

#include "support/generated.hpp"
#include "support/scenes.hpp"
#include "tools/bench/baselines/baseline.hpp"

using namespace clarity;
using namespace clarity::bench;
using namespace clarity::test;

namespace {

// A ball above a ring: it has shadows, and rays which bounce between the two.
Scene ball_and_ring(bool smooth) {
    TriangleMesh mesh = torus(2, 0.7, 48, 24), ball = uv_sphere(0.9, 48, 24);
    ball.transform(1, {0, 0.9, 0});
    mesh.add(ball);
    Scene scene = scene_of(mesh);
    scene.background = {0.25f, 0.5f, 0.75f};
    scene.ambient = {0.1f, 0.2f, 0.05f};
    if (!smooth) return scene;
    // Normals as files may have them: correct on the ball, missing on the ring, and a few which point inwards.
    scene.normals.assign(scene.positions.size(), 0);
    for (size_t v = torus(2, 0.7, 48, 24).positions.size(); v < scene.positions.size(); v += 3)
        for (size_t k = 0; k < 3; ++k) {
            const float from_center = scene.positions[v + k] - (k == 1 ? 0.9f : 0);
            scene.normals.own()[v + k] = v % 21 == 0 ? -from_center : from_center;
        }
    return scene;
}

Settings settings_of(int width, int height, int depth) {
    return make_settings(
        {{"accel", "bvh2"}, {"size", std::to_string(width) + "x" + std::to_string(height)}, {"depth", std::to_string(depth)}});
}

struct Both {
    FloatImage ours, theirs;
    FrameStats stats;
    BaselineRayCounts counts;
};

Both render(const ScenePtr& scene, const View& view, const Settings& settings, const std::string& mode) {
    Both both;
    const View whitted = whitted_view(*scene, view);
    Workbench& bench = Workbench::get();
    Progress progress;
    const auto prepared = bench.prepare(scene, settings);
    both.stats = bench.frames().trace(*prepared, settings, whitted, 0, true, progress);
    both.ours = bench.frames().read_values();
    const BaselineMesh mesh = make_baseline_mesh(*scene);
    const BaselineKind kind = baseline_kinds(nullptr).at(1);
    BaselineArray<float> film;
    EXPECT_GT(kind.build(mesh, kind.quality, 2)->frame_ms(mode, whitted_scene(whitted, settings), film, both.counts), 0);
    both.theirs = {unsigned(settings.width), unsigned(settings.height), 3, {}};
    for (size_t i = 0; i < film.size(); ++i)
        if (i % 4 < 3) both.theirs.pixels.push_back(film[i]);
    return both;
}

View view_of(const Scene& scene) {
    View view = view_from({0.5f, 4, 5}, {0, 0, 0}, 45);
    view.lights = {whitted_light(RT_LIGHT_POINT, {3, 5, 2}, {0.9f, 0.8f, 0.7f})};
    view.background = scene.background;
    view.ambient = scene.ambient;
    return view;
}

void expect_same(const Both& both, const std::string& what) {
    EXPECT_LE(differing_pixels(both.ours, both.theirs, 1.0f / 255), 0.005) << what;
    EXPECT_EQ(both.stats.primary, both.counts.primary) << what;
    EXPECT_NEAR(double(both.counts.shadow), double(both.stats.shadow), 0.002 * double(both.stats.shadow) + 1) << what;
    EXPECT_NEAR(double(both.counts.secondary), double(both.stats.secondary), 0.002 * double(both.stats.secondary) + 1) << what;
}

#define BASELINES_OR_SKIP()                                                   \
    {                                                                         \
        std::string why;                                                      \
        if (baseline_kinds(&why).empty()) GTEST_SKIP() << "SKIPPED: " << why; \
    }

TEST(BaselineFrame, EqualsOurPicture) {
    BASELINES_OR_SKIP()
    for (const bool smooth : {false, true}) {
        const ScenePtr scene = shared_scene(ball_and_ring(smooth));
        for (const char* mode : {"packet16", "packet16 mixed"}) {
            // The size is no multiple of tile or packet.
            const Both both = render(scene, view_of(*scene), settings_of(157, 93, 5), mode);
            expect_same(both, std::string(mode) + (smooth ? ", smooth" : ", flat"));
            EXPECT_GT(both.counts.secondary, 1000u);
            EXPECT_GT(both.counts.shadow, 1000u);
        }
        for (const int depth : {1, 2})
            expect_same(render(scene, view_of(*scene), settings_of(64, 64, depth), "packet16"),
                        "depth " + std::to_string(depth));
        expect_same(render(scene, view_of(*scene), settings_of(1, 1, 5), "packet16"), "one pixel");
    }
}

TEST(BaselineFrame, EqualsOursWithADirectionalLightAndATransformedMesh) {
    BASELINES_OR_SKIP()
    Scene moved = ball_and_ring(true);
    moved.instances[0].world_from_object = {1.5f, 0, 0, 0.2f, 0, 0, -0.8f, 0.1f, 0, 1, 0, -0.3f};
    const ScenePtr scene = shared_scene(std::move(moved));
    View view = view_of(*scene);
    view.lights[0].kind = RT_LIGHT_DIRECTIONAL;
    const float length = std::sqrt(1.0f + 4 + 0.25f);
    const float towards[] = {1 / length, 2 / length, 0.5f / length};
    std::copy_n(towards, 3, view.lights[0].position);
    expect_same(render(scene, view, settings_of(157, 93, 4), "packet16"), "directional, moved");
}

// Checks the comparison itself: it must find a difference where there is one.
TEST(BaselineFrame, DiffersUnderAnotherLight) {
    BASELINES_OR_SKIP()
    const ScenePtr scene = shared_scene(ball_and_ring(false));
    const Both both = render(scene, view_of(*scene), settings_of(64, 64, 3), "packet16");
    View other = view_of(*scene);
    other.lights[0].position[0] = -3;
    EXPECT_GT(differing_pixels(both.ours, render(scene, other, settings_of(64, 64, 3), "packet16").theirs, 1.0f / 255), 0.05);
    EXPECT_EQ(differing_pixels(both.ours, FloatImage{64, 63, 3, FloatPixels(64 * 63 * 3)}, 1), 1);
    other.lights.clear();
    EXPECT_THROW(whitted_view(*scene, other), std::exception);
}

}  // namespace
