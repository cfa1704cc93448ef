// breakdown_test.cpp -- the parts of a frame: they add up to the frame, reduced programs trace the same rays, and leaf tests
// which are done twice do not change the result.
#include "bench/cases/breakdown.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/output/output.hpp"
#include "bench/run/bench.hpp"
#include "support/generated.hpp"
#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::bench;
using namespace clarity::test;

namespace {

double sum_of(const Parts& parts) {
    double sum = 0;
    for (const auto& [name, ms] : parts) sum += ms;
    return sum;
}

double part(const Parts& parts, const std::string& wanted) {
    for (const auto& [name, ms] : parts)
        if (name == wanted) return ms;
    return NAN;
}

TEST(Breakdown, AddsUpToTheFrameWhateverWasMeasured) {
    //                  film rays closest twice one no_shadows whole closest_double_leaf any_twice
    const double ms[kProbes] = {1, 2, 9, 11, 12, 27, 38, 43, 39.5};
    const Breakdown b = break_down(ms);
    EXPECT_DOUBLE_EQ(sum_of(b.parts), 38);
    EXPECT_DOUBLE_EQ(part(b.parts, "film"), 1);
    EXPECT_DOUBLE_EQ(part(b.parts, "camera rays"), 1);
    EXPECT_DOUBLE_EQ(part(b.parts, "leaf tests"), 2);
    EXPECT_DOUBLE_EQ(part(b.parts, "traversal"), 5);
    EXPECT_DOUBLE_EQ(part(b.parts, "shading"), 3);
    EXPECT_DOUBLE_EQ(part(b.parts, "reflections"), 15);
    EXPECT_DOUBLE_EQ(part(b.parts, "shadow rays"), 11);
    EXPECT_DOUBLE_EQ(part(b.within, "leaf tests of shadow rays"), 1.5);
    EXPECT_DOUBLE_EQ(part(b.within, "leaf tests of reflections"), 3);
    const double noise[kProbes] = {3, 1, 4, 1, 5, 9, 2, 6, 5};
    EXPECT_NEAR(sum_of(break_down(noise).parts), 2, 1e-12);
}

TEST(FrameParts, LeafTestsDoneTwiceChangeNothing) {
    Workbench& bench = Workbench::get();
    FrameParts programs(bench.shared_device());
    FrameRenderer frames(bench.shared_device());
    Progress progress;
    // A mesh with normals and single rays; then a scene with all primitives, instances and materials, with packets which
    // diverge.
    const struct {
        const char *scene, *accel, *lanes;
    } cases[] = {{"scenes/thesis/models/teapot.obj", "bvh2", "1"}, {"scenes/primitives.scene", "bvh8", "16"}};
    for (const auto& c : cases) {
        const ScenePtr scene = load_scene(source_file(c.scene));
        const Settings settings = make_settings({{"accel", c.accel}, {"lanes", c.lanes}, {"size", "70x50"}, {"depth", "3"}});
        const auto whole = bench.prepare(scene, settings);
        const View view = make_view(*scene, 1.4f);
        const auto picture = [&](FramePart part) {
            frames.trace(*programs.prepare(*whole, part), whole->settings, view, 0, false, progress);
            return frames.read_values().pixels;
        };
        const FloatPixels once = picture(FramePart::whole);
        for (const FramePart twice : {FramePart::whole_closest_double_leaf, FramePart::whole_any_double_leaf})
            EXPECT_EQ(picture(twice), once) << c.scene;
    }
}

TEST(FrameParts, BeginAsAFrameBegins) {
    Workbench& bench = Workbench::get();
    FrameParts programs(bench.shared_device());
    FrameRenderer frames(bench.shared_device());
    Progress progress;
    const ScenePtr scene = shared_scene(scene_of(torus(2, 0.7, 48, 24)));
    View view = view_from({0.5f, 4, 5}, {0, 0, 0}, 45);
    view.background = {0.25f, 0.5f, 0.75f};
    for (const char* lanes : {"1", "16"}) {
        const Settings settings = make_settings({{"accel", "bvh2"}, {"lanes", lanes}, {"size", "70x50"}, {"depth", "1"}});
        const auto whole = bench.prepare(scene, settings);
        const auto trace = [&](FramePart part) {
            frames.trace(*programs.prepare(*whole, part), whole->settings, view, 0, false, progress);
        };
        trace(FramePart::film);
        const FloatImage film = frames.read_values();
        for (size_t i = 0; i < film.pixels.size(); ++i) ASSERT_EQ(film.pixels[i], view.background[i % 3]);
        trace(FramePart::rays);
        EXPECT_NE(frames.read_values().pixels, film.pixels);
        trace(FramePart::whole);
        const FloatImage distances = frames.read_distance();
        for (const FramePart part : {FramePart::closest, FramePart::closest_double_leaf}) {
            trace(part);
            EXPECT_EQ(frames.read_distance().pixels, distances.pixels) << lanes << " lanes";
        }
    }
}

// The whole way from a scene to its records.
TEST(Breakdown, MeasuresTheFrameOfAScene) {
    Workbench& bench = Workbench::get();
    BenchRequest request;
    request.breakdown = true;
    request.files = {source_file("scenes/thesis/models/ball.obj")};
    request.accels = {"bvh2"};
    request.settings = {{"size", "96x64"}};
    request.time_limit_s = 120;
    const Suite suite = make_suite(request, SceneCatalog("", ""), bench.plugins());
    ASSERT_EQ(suite.cases.size(), 4u);
    BenchOptions options;
    options.devices = {bench.device().info()};
    options.rules.max_spread = 100;
    options.rules.max_rounds = 9;
    Progress progress;
    BenchReport report = run_bench(bench.plugins(), request, suite, options, progress);
    ASSERT_EQ(report.records.size(), 4u);
    const BenchRecord& row = report.records[0];
    ASSERT_EQ(row.status, RowStatus::ok) << row.why;
    ASSERT_EQ(row.parts_ms.size(), 9u);
    const double shown = part(row.parts_ms, "tone map") + part(row.parts_ms, "read-back");
    EXPECT_GT(shown, 0);
    EXPECT_NEAR(sum_of(row.parts_ms) - shown, row.time_ms.median, 1e-9);
    EXPECT_GT(part(row.parts_ms, "film"), 0);
    EXPECT_EQ(row.within_ms.size(), 2u);
    for (size_t i = 1; i < 4; ++i) {
        EXPECT_TRUE(report.records[i].analysis.present) << report.records[i].why;
        EXPECT_GT(report.records[i].analysis.lanes_alive, 0);
        EXPECT_GT(report.records[i].analysis.leaf_tests_per_ray, 0);
    }
    const std::string table = breakdown_table(report);
    for (const char* text : {"shadow rays", "reflections", "tone map", "leaf tests of shadow rays"})
        EXPECT_NE(table.find(text), std::string::npos) << table;
    EXPECT_EQ(breakdown_table(read_bench_json(bench_json(report))), table);
    EXPECT_NE(bench_csv(report).find("camera rays "), std::string::npos);
}

}  // namespace
