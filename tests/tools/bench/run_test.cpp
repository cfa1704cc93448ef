// run_test.cpp -- the rows which are kept when a run ends early.
#include <gtest/gtest.h>

#include <new>

#include "base/error.hpp"
#include "support/scenes.hpp"
#include "support/workbench.hpp"
#include "tools/bench/measured.hpp"
#include "tools/bench/run/bench.hpp"

using namespace clarity;
using namespace clarity::bench;
using namespace clarity::test;

namespace {

// Three cases with one row each; they are counted, not timed.
class Run : public testing::Test {
 protected:
    Run() {
        request_.files = {source_file("scenes/thesis/models/ball.obj")};
        request_.accels = {"bvh2"};
        request_.baselines = false;
        request_.settings = {{"size", "32x24"}};
        request_.time_limit_s = 600;
        request_.only = {"/primary", "/shadow", "/reflection"};
        options_.devices = {Workbench::get().device().info()};
    }
    BenchReport run(Progress& progress) {
        const PluginRegistry& plugins = Workbench::get().plugins();
        Suite suite = make_suite(request_, SceneCatalog("", ""), plugins);
        for (BenchCase& c : suite.cases) c.timing = Timing::counted_only;
        EXPECT_EQ(suite.cases.size(), 3u);
        return run_bench(plugins, request_, suite, options_, progress);
    }

    BenchRequest request_;
    BenchOptions options_;
};

TEST_F(Run, ReportsEachRowAtOnce) {
    std::vector<size_t> counts;
    options_.on_row = [&](const BenchReport& report) { counts.push_back(report.records.size()); };
    Progress progress;
    const BenchReport report = run(progress);
    EXPECT_EQ(counts, (std::vector<size_t>{1, 2, 3}));
    EXPECT_EQ(report.failure, "");
    EXPECT_TRUE(all_ok(report));
}

TEST_F(Run, KeepsItsRowsWhenMemoryRunsOut) {
    struct Greedy : Progress {
        void stage(const std::string& text) override {
            if (text.rfind("3/3 ", 0) == 0) throw std::bad_alloc();
        }
    } progress;
    const BenchReport report = run(progress);
    ASSERT_EQ(report.records.size(), 2u);
    EXPECT_EQ(report.records[1].status, RowStatus::ok) << report.records[1].why;
    EXPECT_NE(report.failure.find("not enough memory"), std::string::npos) << report.failure;
    EXPECT_FALSE(all_ok(report));
}

TEST_F(Run, KeepsItsRowsWhenTheyCannotBeWritten) {
    options_.on_row = [](const BenchReport& report) {
        if (report.records.size() == 2) throw Error(Exit::failed, "a.json: cannot be written: the disk is full");
    };
    Progress progress;
    const BenchReport report = run(progress);
    EXPECT_EQ(report.records.size(), 2u);
    EXPECT_EQ(report.failure, "a.json: cannot be written: the disk is full");
}

// Refits, builds and rays of a scene that moves: all rows are complete, and rays hit the same after a refit and after a build.
TEST(Moving, RowsOfAllMeasures) {
    BenchRequest request;
    request.suites = {"moving"};
    request.files = {source_file("scenes/thesis/models/ball.obj")};
    request.accels = {"bvh8"};
    request.settings = {{"size", "32x24"}};
    request.only = {"wave"};
    request.time_limit_s = 600;  // the first repetition compiles kernels, beside another test
    const BenchReport report = measured(request);
    EXPECT_EQ(report.failure, "");
    size_t refits = 0, rays = 0;
    for (const BenchRecord& r : report.records) {
        EXPECT_EQ(r.status, RowStatus::ok) << r.case_name << ", " << r.name() << ": " << r.why;
        if (r.measure == "refit") {
            ++refits;
            EXPECT_GT(r.mtris_per_s, 0) << r.name();
            EXPECT_GT(r.bytes_per_triangle, 0) << r.name();
        } else if (r.measure != "rebuild") {
            ++rays;
            EXPECT_GT(r.hits, 0u) << r.name();
        }
    }
    EXPECT_GE(refits, 1u);
    EXPECT_EQ(rays, 4u) << "primary and diffuse, built and refitted";
}

}  // namespace
