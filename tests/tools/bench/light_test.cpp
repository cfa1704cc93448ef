// light_test.cpp -- the suite light: its cases, the errors that it finds, and how its rows are written.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "base/pictures/image_io.hpp"
#include "support/scenes.hpp"
#include "support/scratch.hpp"
#include "support/workbench.hpp"
#include "tools/bench/cases/light.hpp"
#include "tools/bench/measured.hpp"
#include "tools/bench/output/output.hpp"
#include "tools/bench/run/bench.hpp"
#include "tools/compare/picture_errors.hpp"

using namespace clarity;
using namespace clarity::bench;
using namespace clarity::test;

namespace {

// A lamp over a floor.
constexpr const char* kRoom =
    "camera main eye 0 2 6 target 0 1 0 fov 40\n"
    "light rect center 0 3 0 u .5 0 0 v 0 0 .5 radiance 8\n"
    "material floor model lambert color .6\n"
    "polygon material floor vertices -4 0 4  4 0 4  4 0 -4  -4 0 -4\n";

class BenchLight : public testing::Test {
 protected:
    BenchLight() {
        std::ofstream(scratch_.path("room.scene")) << kRoom;
        request_.suites = {"light"};
        request_.files = {scratch_.path("room.scene")};
        request_.accels = {"linear"};
        request_.settings = {{"size", "24x16"}, {"spp", "20"}, {"sampler", "independent"}, {"lanes", "4"}};
        request_.only = {"/light"};
        request_.time_limit_s = 600;
    }
    BenchReport run() { return measured(request_); }
    // The picture of the request's settings with that seed and so many samples, written as a file.
    std::string reference(const char* seed, unsigned samples) const {
        std::vector<std::pair<std::string, std::string>> pairs = request_.settings;
        pairs.insert(pairs.end(), {{"accel", "linear"}, {"tracer", "path"}, {"depth", "8"}, {"seed", seed}});
        const Settings settings = make_settings(pairs);
        Workbench& bench = Workbench::get();
        Progress progress;
        const LoadedScene loaded = load_scene(bench.plugins(), scene_of_file(request_.files[0]), 1.5f, {}, progress);
        const auto prepared = bench.prepare(loaded.scene, settings);
        bench.frames().trace(*prepared, settings, loaded.view, Samples{0, samples}, false, progress);
        const std::string file = scratch_.path(std::string("reference") + seed + ".pfm");
        write_image(file, bench.frames().read_values(), {}, picture_notes());
        return file;
    }

    const Scratch scratch_;
    BenchRequest request_;
};

// The errors are those of the picture that was measured: against itself there is none at the end, and some before.
TEST_F(BenchLight, ErrorsAreOfThePictureAtItsSamples) {
    request_.reference = reference("0", 20);
    const BenchReport report = run();
    ASSERT_EQ(report.records.size(), 1u);
    const BenchRecord& r = report.records[0];
    ASSERT_EQ(r.status, RowStatus::ok) << r.why;
    std::vector<unsigned> samples;
    for (const LightRun::Point& point : r.light.points) samples.push_back(point.samples);
    EXPECT_EQ(samples, (std::vector<unsigned>{1, 4, 16, 20}));
    for (size_t i = 0; i + 1 < samples.size(); ++i) {
        EXPECT_GT(r.light.points[i].rmse, 1e-3);
        EXPECT_LT(r.light.points[i].ms, r.light.points[i + 1].ms);
    }
    EXPECT_EQ(r.light.points.back().rmse, 0);
    EXPECT_EQ(r.light.reference, request_.reference);
    EXPECT_EQ(r.light.sampler, "independent");
    EXPECT_GT(r.light.msamples_per_s, 0);
    EXPECT_NEAR(r.light.msamples_per_s, 24 * 16 * 16 / r.wall_ms.median / 1000, 1e-9) << "16 samples are timed";
    EXPECT_GT(r.rays(), 24u * 16 * 16);
    // Origin, direction, weight, light and absorption alone are 60 bytes.
    EXPECT_GE(r.light.state_bytes, 60u);
    EXPECT_LE(r.light.state_bytes, 256u);
}

// Without a file the reference has other random numbers, so no error vanishes, and errors fall with the samples.
TEST_F(BenchLight, RendersAReferenceOfAnotherSeed) {
    request_.settings[1].second = "64";
    const BenchReport report = run();
    ASSERT_EQ(report.records.size(), 1u);
    const LightRun& light = report.records[0].light;
    ASSERT_EQ(light.points.size(), 4u) << report.records[0].why;
    for (const LightRun::Point& point : light.points) {
        EXPECT_GT(point.rmse, 1e-4);
        EXPECT_GE(point.rmse * (1 + 1e-9), point.trimmed_rmse);
    }
    EXPECT_NEAR(light.slope, -.5, .12);
    EXPECT_EQ(light.reference, "1024 samples of another seed");
}

TEST_F(BenchLight, AReferenceOfAnotherSizeSaysWhatToDo) {
    request_.reference = reference("0", 1);
    request_.settings[0].second = "16x16";
    const BenchReport report = run();
    ASSERT_EQ(report.records.size(), 1u);
    EXPECT_NE(report.records[0].status, RowStatus::ok);
    EXPECT_NE(report.records[0].why.find("24x16"), std::string::npos) << report.records[0].why;
    EXPECT_NE(report.records[0].why.find("--size"), std::string::npos) << report.records[0].why;
}

TEST(BenchLightSuite, ComparesSamplersUnlessOneIsAsked) {
    const SceneCatalog project(source_file("scenes"), "");
    BenchRequest request;
    request.suites = {"light"};
    const Suite both = make_suite(request, project, Workbench::get().plugins());
    std::vector<std::string> names;
    for (const BenchCase& c : both.cases) names.push_back(c.name);
    EXPECT_EQ(names, (std::vector<std::string>{"cornell/light", "spheres_sky/light", "veach/light", "showpiece_sky/light",
                                               "showpiece_sky/start"}));
    EXPECT_EQ(both.notes.size(), 1u) << "the bathroom is a shared model";
    ASSERT_EQ(both.cases[0].variants.size(), 2u);
    EXPECT_EQ(both.cases[0].variants[0].label, "independent");
    request.settings = {{"sampler", "sobol"}, {"spp", "8"}};
    const Suite one = make_suite(request, project, Workbench::get().plugins());
    ASSERT_EQ(one.cases[0].variants.size(), 1u);
    const Settings settings = variant_settings(Workbench::get().plugins(), request, one.cases[0].variants[0]);
    EXPECT_EQ(settings.sampler, "sobol");
    EXPECT_EQ(settings.spp, 8);
    EXPECT_EQ(settings.tracer, "path");
    EXPECT_EQ(settings.width, 256);
}

BenchReport two_rows() {
    BenchReport report;
    BenchRecord r;
    r.suite = "light";
    r.scene = "room";
    r.case_name = "room/light";
    r.measure = "light";
    r.variant = "sobol";
    r.wall_ms = r.time_ms = {100, 99, 101, 98, 102, 9};
    r.light = {"sobol", "mis", "a.pfm", 1.5, -.625, {{1, 10, .5, .25, .125}, {4, 40, .25, .125, .0625}}, 112, -1, -1};
    report.records.push_back(r);
    r.variant = "other";
    r.light.registers = 128;
    r.light.spilled_bytes = 0;
    report.records.push_back(r);
    return report;
}

TEST(BenchLightRecords, SurviveWritingAndReading) {
    const BenchReport report = two_rows();
    const BenchReport again = read_bench_json(bench_json(report));
    ASSERT_EQ(again.records.size(), 2u);
    EXPECT_EQ(bench_json(again), bench_json(report));
    const LightRun &first = again.records[0].light, &second = again.records[1].light;
    ASSERT_EQ(first.points.size(), 2u);
    EXPECT_EQ(first.points[1].samples, 4u);
    EXPECT_EQ(first.points[1].relmse, .0625);
    EXPECT_EQ(first.slope, -.625);
    EXPECT_EQ(first.registers, -1) << "what a driver does not tell is not 0";
    EXPECT_EQ(second.spilled_bytes, 0);
    EXPECT_NE(bench_csv(report).find("1 0.5; 4 0.25"), std::string::npos) << bench_csv(report);
    BenchReport refused = report;
    refused.records[0].status = RowStatus::refused;
    EXPECT_TRUE(read_bench_json(bench_json(refused)).records[0].light.points.empty()) << "figures are withheld";
}

TEST(BenchLightRecords, TheTableTellsWhatTheDriverDoesNot) {
    const std::string table = bench_table(two_rows());
    EXPECT_NE(table.find("-0.625"), std::string::npos) << table;
    EXPECT_NE(table.find("0.0625"), std::string::npos) << table;
    EXPECT_NE(table.find("not told"), std::string::npos) << table;
    EXPECT_NE(table.find("128"), std::string::npos) << table;
}

TEST(BenchLightRegisters, AreThoseOfTheKernel) {
    const std::string log =
        "ptxas info    : Function properties for rt_state_bytes\n"
        "    0 bytes stack frame, 1 bytes spill stores, 2 bytes spill loads\n"
        "ptxas info    : Used 8 registers, 328 bytes cmem[0]\n"
        "ptxas info    : Function properties for trace_path\n"
        "    512 bytes stack frame, 24 bytes spill stores, 36 bytes spill loads\n"
        "ptxas info    : Used 128 registers, 400 bytes cmem[0]\n";
    const RegisterUse use = register_use(log, "trace_path");
    EXPECT_EQ(use.registers, 128);
    EXPECT_EQ(use.spilled_bytes, 24);
    EXPECT_EQ(register_use("", "trace_path").registers, -1);
    EXPECT_EQ(register_use(log, "trace").spilled_bytes, -1) << "the whole name counts";
}

TEST(ErrorSlope, IsTheExponent) {
    EXPECT_NEAR(error_slope({{1, 2.0}, {4, 1.0}, {16, .5}}), -.5, 1e-12);
    EXPECT_NEAR(error_slope({{1, 1.0}, {10, .1}, {20, 0}}), -1, 1e-12) << "no error has no logarithm";
    EXPECT_TRUE(std::isnan(error_slope({{1, 1.0}})));
}

}  // namespace
