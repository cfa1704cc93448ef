// speedup_test.cpp -- our speed-up over the fastest baseline: which rows are compared, and the means over scenes.
#include "tools/bench/output/speedup.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/bench/output/output.hpp"

namespace {

using namespace clarity;
using namespace clarity::bench;

BenchRecord row(const std::string& scene, const std::string& measure, const std::string& variant, const std::string& baseline,
                double speed) {
    BenchRecord r;
    r.suite = "cpu";
    r.case_name = scene + "/" + measure;
    r.scene = scene;
    r.measure = measure;
    r.variant = baseline.empty() ? variant : baseline;
    r.baseline = baseline;
    r.baseline_quality = baseline.substr(baseline.rfind(' ') + 1);
    r.device = "a processor";
    r.device_id = baseline.empty() && measure != "build" ? "0:0" : "host";
    r.time_ms = r.wall_ms = {1, 1, 1, 1, 1, 9};
    r.rays_primary = 1000;
    (measure == "build" ? r.mtris_per_s : measure == "whitted" ? r.fps : r.mrays_per_s) = speed;
    return r;
}

TEST(Speedup, ComparesWithTheFastestMeasuredBaseline) {
    std::vector<BenchRecord> rows = {
        row("a", "shadow", "bvh2", "", 30), row("a", "shadow", "bvh8", "", 10), row("a", "shadow", "", "embree single high", 5),
        row("a", "shadow", "", "embree packet16 high", 20), row("a", "shadow", "", "embree packet8 high", 99)};
    rows[4].status = RowStatus::refused;
    compare_with_baselines(rows);
    EXPECT_EQ(rows[0].speedup.baseline, "embree packet16 high");
    EXPECT_DOUBLE_EQ(rows[0].speedup.ratio, 1.5);
    EXPECT_DOUBLE_EQ(rows[1].speedup.ratio, 0.5);
    for (size_t i = 2; i < rows.size(); ++i) EXPECT_TRUE(rows[i].speedup.baseline.empty());
}

TEST(Speedup, ComparesBuildsWithTheMediumQualityAndComparesBytes) {
    std::vector<BenchRecord> rows = {row("a", "build", "bvh2", "", 3), row("a", "build", "", "embree low", 20),
                                     row("a", "build", "", "embree medium", 4)};
    rows[0].accel_bytes = 50;
    rows[2].accel_bytes = 100;
    compare_with_baselines(rows);
    EXPECT_EQ(rows[0].speedup.baseline, "embree medium");
    EXPECT_DOUBLE_EQ(rows[0].speedup.ratio, 0.75);
    EXPECT_DOUBLE_EQ(rows[0].speedup.bytes_ratio, 0.5);
}

TEST(Speedup, ComparesABuildWithTheBaselineBuildOfLikeQuality) {
    std::vector<BenchRecord> rows = {row("a", "build", "sorted", "", 30),       row("a", "build", "cut", "", 3),
                                     row("a", "build", "usual", "", 4),         row("a", "build", "", "embree low", 20),
                                     row("a", "build", "", "embree medium", 8), row("a", "build", "", "embree high", 2)};
    rows[0].accel_params = "max_leaf=7,builder=morton";
    rows[1].accel_params = "max_leaf=7,builder=spatial";
    rows[2].accel_params = "max_leaf=7,builder=sah";
    compare_with_baselines(rows);
    EXPECT_EQ(rows[0].speedup.baseline, "embree low");
    EXPECT_DOUBLE_EQ(rows[0].speedup.ratio, 1.5);
    EXPECT_EQ(rows[1].speedup.baseline, "embree high");
    EXPECT_DOUBLE_EQ(rows[1].speedup.ratio, 1.5);
    EXPECT_EQ(rows[2].speedup.baseline, "embree medium");
    EXPECT_DOUBLE_EQ(rows[2].speedup.ratio, 0.5);
}

TEST(Speedup, NoneWithoutAMeasuredBaseline) {
    std::vector<BenchRecord> rows = {row("a", "shadow", "bvh2", "", 30)};
    rows.push_back(row("a", "shadow", "", "embree single high", 5));
    rows[1].status = RowStatus::failed;
    compare_with_baselines(rows);
    EXPECT_TRUE(rows[0].speedup.baseline.empty());
    BenchReport report;
    report.records = rows;
    EXPECT_TRUE(speedup_means(report).empty());
    EXPECT_EQ(speedup_table(report), "");
}

BenchReport three_scenes() {
    BenchReport report;
    const double ours[] = {10, 40, 90}, theirs[] = {10, 20, 20};  // ratios 1, 2, 4.5
    const char* const names[] = {"one", "two", "three"};
    for (int i = 0; i < 3; ++i) {
        std::vector<BenchRecord> rows = {row(names[i], "primary", "bvh2", "", ours[i]),
                                         row(names[i], "primary", "bvh8", "", 2 * ours[i]),
                                         row(names[i], "primary", "", "embree packet16 high", theirs[i])};
        compare_with_baselines(rows);
        report.records.insert(report.records.end(), rows.begin(), rows.end());
    }
    std::vector<BenchRecord> frames = {row("two", "whitted", "bvh2", "", 60),
                                       row("two", "whitted", "", "embree packet16 medium", 80)};
    compare_with_baselines(frames);
    report.records.insert(report.records.end(), frames.begin(), frames.end());
    return report;
}

TEST(Speedup, MeansAreGeometricPerStructure) {
    const auto means = speedup_means(three_scenes());
    ASSERT_EQ(means.size(), 3u);
    EXPECT_EQ(means[0].variant, "bvh2");
    EXPECT_EQ(means[0].rows, 3u);
    EXPECT_NEAR(means[0].mean, std::cbrt(9.0), 1e-12);
    EXPECT_DOUBLE_EQ(means[0].least, 1);
    EXPECT_EQ(means[0].least_scene, "one");
    EXPECT_NEAR(means[1].mean, 2 * std::cbrt(9.0), 1e-12);
    EXPECT_EQ(means[2].measure, "whitted");
    EXPECT_DOUBLE_EQ(means[2].mean, 0.75);
}

TEST(Speedup, TableAndJsonShowItAndJsonReadsItBack) {
    const BenchReport report = three_scenes();
    const std::string table = speedup_table(report);
    for (const char* text : {"GEOMETRIC MEAN", "LEAST", "2.08", "4.16", "0.75", "three"})
        EXPECT_NE(table.find(text), std::string::npos) << text << "\n" << table;
    EXPECT_NE(bench_table(report).find(table), std::string::npos);
    const auto json = nlohmann::json::parse(bench_json(report));
    EXPECT_NEAR(json[0]["versus"]["geometric_mean"].get<double>(), 2.08008, 1e-5);
    EXPECT_EQ(json[0]["versus"]["peer"], "embree packet16 high");
    EXPECT_EQ(json[3]["versus"]["ratio"], 2);
    EXPECT_EQ(json[3]["versus"]["least"], 1);
    EXPECT_TRUE(json[2]["versus"].is_null());
    EXPECT_EQ(speedup_table(read_bench_json(bench_json(report))), table);
    EXPECT_NE(bench_csv(report).find("versus.geometric_mean"), std::string::npos);
}

// Two rows of the same structure, on a machine where times spread over a quarter of the median.
std::vector<BenchRecord> twice_on_a_busy_machine(const char* measure, double ratio) {
    std::vector<BenchRecord> rows = {row("a", measure, "bvh2", "", 20 * ratio),
                                     row("a", measure, "", "embree packet16 high", 20)};
    for (BenchRecord& r : rows) r.time_ms = r.wall_ms = {1, 0.9, 1.15, 0.8, 2, 9};
    compare_with_baselines(rows);
    return rows;
}

TEST(Speedup, ADifferenceWithinTheSpreadIsAboutTheSame) {
    for (const char* measure : {"primary", "whitted"})
        for (const double ratio : {1.23, 1 / 1.23, 1.0}) {
            BenchReport report;
            report.records = twice_on_a_busy_machine(measure, ratio);
            EXPECT_NEAR(report.records[0].speedup.spread, std::sqrt(2) * 0.25, 1e-12);
            const std::string table = speedup_table(report);
            EXPECT_NE(table.find(" same\n"), std::string::npos) << table;
            EXPECT_EQ(table.find("1.23"), std::string::npos) << table;
            EXPECT_EQ(table.find("0.81"), std::string::npos) << table;
        }
    BenchReport report;
    report.records = twice_on_a_busy_machine("primary", 1.5);
    EXPECT_NE(speedup_table(report).find("1.50"), std::string::npos) << speedup_table(report);
    EXPECT_EQ(speedup_table(report).find(" same\n"), std::string::npos);
}

TEST(Speedup, JsonReadsTheSpreadBack) {
    BenchReport report;
    report.records = twice_on_a_busy_machine("primary", 1.23);
    EXPECT_NEAR(read_bench_json(bench_json(report)).records[0].speedup.spread, std::sqrt(2) * 0.25, 1e-5);
}

TEST(Speedup, MeansOfManyScenesHaveLessSpread) {
    BenchReport report;
    for (const char* scene : {"a", "b", "c", "d"}) {
        std::vector<BenchRecord> rows = twice_on_a_busy_machine("primary", 1.3);
        for (BenchRecord& r : rows) r.scene = scene;
        report.records.insert(report.records.end(), rows.begin(), rows.end());
    }
    const auto means = speedup_means(report);
    ASSERT_EQ(means.size(), 1u);
    EXPECT_NEAR(means[0].mean_spread, std::sqrt(2) * 0.25 / 2, 1e-12);
    EXPECT_FALSE(about_same(means[0].mean, means[0].mean_spread));
    EXPECT_TRUE(about_same(means[0].least, means[0].least_spread));
}

TEST(Speedup, FramesOfVariantsThenAndNowMayBeAboutTheSame) {
    BenchReport report;
    for (const char* variant : {"then", "now"}) {
        BenchRecord r = row("a", "frame", variant, "", 0);
        r.suite = "quick";
        r.depth = 4;
        r.fps = variant[0] == 'n' ? 12.3 : 10;
        r.wall_ms = {100, 90, 115, 80, 200, 9};
        report.records.push_back(r);
    }
    const std::string table = bench_table(report);
    EXPECT_NE(table.find(" same\n"), std::string::npos) << table;
    EXPECT_EQ(table.find("1.23"), std::string::npos) << table;
}

// A case that was measured with 1 and 4 threads: its rate with one, how many times as fast with four, and the peer's ratios.
TEST(ThreadsTable, ShowsWhatRowsGain) {
    BenchReport report;
    for (const unsigned threads : {1u, 4u}) {
        for (const char* scene : {"a", "b"}) {
            BenchRecord r = row(scene, "primary", "bvh2", "", threads == 1 ? 10 : scene[0] == 'a' ? 20 : 45);
            r.threads = threads;
            r.speedup.baseline = "embree single high";
            r.speedup.ratio = threads == 1 ? 1.5 : 1.25;
            report.records.push_back(r);
        }
    }
    const std::string table = threads_table(report);
    for (const char* text :
         {"M/s with 1", "x by 4", "peer, 4", "10.0", "2.00", "4.50", "1.25", "GEOMETRIC MEAN, primary", "3.00"})
        EXPECT_NE(table.find(text), std::string::npos) << text << "\n" << table;
    EXPECT_NE(bench_table(report).find(table), std::string::npos);
    report.records.resize(2);
    EXPECT_EQ(threads_table(report), "");
}

}  // namespace
