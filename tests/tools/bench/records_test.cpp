// records_test.cpp -- records survive writing and reading, and the figures of refused rows are withheld.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/error.hpp"
#include "support/errors.hpp"
#include "support/scratch.hpp"
#include "tools/bench/output/output.hpp"
#include "tools/bench/output/rows_file.hpp"
#include "tools/bench/run/bench.hpp"

namespace {

using namespace clarity;
using namespace clarity::bench;
using Json = nlohmann::json;

BenchRecord frame_record(const std::string& scene, const std::string& variant, double ms) {
    BenchRecord r;
    r.suite = "thesis";
    r.case_name = scene + "/4 steps";
    r.scene = scene;
    r.measure = "frame";
    r.variant = variant;
    r.device = "a device, \"quoted\"";
    r.device_id = "0:0";
    r.driver = "driver 1";
    r.threads = 2;
    r.accel = "bvh2";
    r.accel_params = "max_leaf=4,bins=32";
    r.tracer = "iterative";
    r.depth = 4;
    r.packet_w = 4;
    r.packet_h = 2;
    r.lanes = 8;
    r.ray_slots = 8;
    r.width = 1024;
    r.height = 768;
    r.triangles = 2406;
    r.primitives = 2407;
    r.time_ms = {ms, ms * 0.99, ms * 1.01, ms * 0.9, ms * 1.2, 25};
    r.wall_ms = {ms + 1, ms + 0.9, ms + 1.1, ms, ms + 2, 25};
    r.fps = 1000 / (ms + 1);
    r.rays_primary = 786432;
    r.rays_shadow = 500000;
    r.rays_secondary = 300000;
    r.rays_dropped = 17;
    r.mrays_per_s = double(r.rays()) / ms / 1000;
    r.build_ms = 1.5;
    r.pack_ms = 0.25;
    r.accel_bytes = 123456;
    r.bytes_per_triangle = 51.3117;
    r.nodes = 1203;
    r.sah_cost = 42.5;
    r.kernels_ms = {{"trace", ms}, {"tone map", 0.5}};
    return r;
}

BenchRecord ray_record() {
    BenchRecord r = frame_record("bunny", "bvh2", 8);
    r.suite = "accel";
    r.case_name = "bunny/diffuse";
    r.measure = "diffuse";
    r.wall_ms = {};
    r.fps = 0;
    r.kernels_ms.clear();
    r.hits = 400000;
    r.analysis.present = true;
    r.analysis.nodes_per_ray = 55.5;
    r.analysis.own_nodes_per_ray = 33.25;
    r.analysis.leaf_tests_per_ray = 12;
    r.analysis.lanes_alive = 0.6;
    r.analysis.bytes_per_ray = 300;
    r.analysis.bytes_shared = 0.9;
    r.analysis.node_bytes = 64;
    r.analysis.boxes_per_ray = 90.5;
    r.analysis.reported = "boxes";
    return r;
}

BenchReport sample() {
    BenchReport report;
    report.run.version = "1.2.3";
    report.run.date = "2026-11-21T12:00:00Z";
    report.run.command = "clarity bench thesis";
    report.run.host_cpu = "a processor";
    report.run.host_threads = 2;
    report.run.clock_mhz_before = 2600.5;
    report.run.load_after = 0.25;
    report.run.max_spread = 0.1;
    report.records = {frame_record("one", "now", 10), frame_record("one", "then", 100), ray_record()};
    BenchRecord baseline = ray_record();
    baseline.baseline = baseline.variant = "embree packet16 high";
    baseline.accel.clear();
    baseline.analysis = {};
    report.records.push_back(baseline);
    BenchRecord refused = ray_record();
    refused.status = RowStatus::refused;
    refused.why = "spreads over 40 %";
    refused.variant = "unsteady";
    report.records.push_back(refused);
    return report;
}

TEST(Json, IsAListOfRecordsWithTheDocumentedKeys) {
    const Json list = Json::parse(bench_json(sample()));
    ASSERT_TRUE(list.is_array());
    ASSERT_EQ(list.size(), 5u);
    for (const char* key :
         {"case", "peer", "device", "accel", "tracer", "depth", "packet", "lanes", "size", "frame_ms", "build_ms", "compile_ms",
          "rays", "mrays_per_s", "dropped_rays", "nodes", "accel_bytes", "triangles"})
        for (const Json& record : list) EXPECT_TRUE(record.contains(key)) << key;
    EXPECT_EQ(list[0]["case"], "one/4 steps");
    EXPECT_TRUE(list[0]["peer"].is_null());
    EXPECT_EQ(list[3]["peer"], "embree packet16 high");
    EXPECT_EQ(list[0]["packet"], "4x2");
    EXPECT_EQ(list[0]["frame_ms"]["median"], 10);
    EXPECT_TRUE(list[2]["frame_ms"].is_null());
    EXPECT_EQ(list[0]["rays"]["shadow"], 500000);
    EXPECT_EQ(list[0]["run"]["clock_mhz"]["before"], 2600.5);
}

TEST(Json, ReadAndWrittenAgainIsUnchanged) {
    const std::string once = bench_json(sample());
    EXPECT_EQ(bench_json(read_bench_json(once)), once);
}

TEST(Json, RunsOfJoinedFilesStaySeparate) {
    BenchReport report = sample();
    BenchRun other = report.run;
    other.host_cpu = "another machine";
    report.joined = {other};
    report.records[1].run = 1;
    const BenchReport read = read_bench_json(bench_json(report));
    ASSERT_EQ(read.joined.size(), 1u);
    EXPECT_EQ(read.run_of(read.records[0]).host_cpu, "a processor");
    EXPECT_EQ(read.run_of(read.records[1]).host_cpu, "another machine");
    EXPECT_EQ(read.run_of(read.records[2]).host_cpu, "a processor");
}

TEST(Json, RefusedRecordsHaveNoFigures) {
    const Json refused = Json::parse(bench_json(sample()))[4];
    EXPECT_EQ(refused["status"], "refused");
    EXPECT_EQ(refused["why"], "spreads over 40 %");
    EXPECT_FALSE(refused["time_ms"].contains("median"));
    EXPECT_TRUE(refused["time_ms"].contains("spread"));
    for (const char* key : {"fps", "mrays_per_s", "build_ms", "kernels_ms"}) EXPECT_TRUE(refused[key].is_null()) << key;
    // Counts do not depend on time.
    for (const char* key : {"rays", "analysis", "hits", "nodes"}) EXPECT_FALSE(refused[key].is_null()) << key;
    EXPECT_EQ(refused["hits"], 400000);
    BenchReport failed = sample();
    failed.records[4].status = RowStatus::failed;
    for (const char* key : {"rays", "analysis", "hits", "nodes"})
        EXPECT_TRUE(Json::parse(bench_json(failed))[4][key].is_null()) << key;
}

// A mesh of 8 parts costs more memory than the shape, and less time; one of 32 parts costs more of both.
TEST(Table, ShapesCrossTheirMeshesAndMissRays) {
    BenchReport report;
    const auto add = [&](const char* scene, uint64_t bytes, double mrays, uint64_t hits, const char* measure = "primary") {
        BenchRecord row = ray_record();
        row.suite = "shapes";
        row.scene = scene;
        row.measure = measure;
        row.accel_bytes = bytes;
        row.mrays_per_s = mrays;
        row.hits = hits;
        row.clock = "processor";
        report.records.push_back(row);
    };
    add("cone", 112, 100, 1000);
    add("cone, 8 parts", 576, 150, 936);
    add("cone, 32 parts", 1984, 50, 995);
    add("cone, 32 parts", 1984, 50, 1, "diffuse");  // other rays: not compared
    const std::string text = bench_table(report);
    for (const char* part : {" 6.40 ", " 0.500 ", "0.069", "0.0043", "rays in a second of one processor"})
        EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
    EXPECT_EQ(text.find("99.9"), std::string::npos) << text;
    EXPECT_EQ(Json::parse(bench_json(report))[0]["clock"], "processor");
    report.records[0].clock.clear();
    EXPECT_TRUE(Json::parse(bench_json(report))[0]["clock"].is_null());
}

TEST(Json, BadFilesAreRefusedAndTheRecordIsNamed) {
    for (const char* text :
         {"", "{}", "[1]", "[{\"status\": \"ok\"}, {\"status\": \"splendid\"}]", "[{\"status\": \"ok\", \"lanes\": \"x\"}]",
          "[{\"status\": \"ok\", \"packet\": \"4\"}]", "[[]]", "null", "[{\"status\":"}) {
        SCOPED_TRACE(text);
        expect_error([&] { read_bench_json(text); }, {"record "});
    }
}

// A strict parser of CSV as RFC 4180 defines it.
std::vector<std::vector<std::string>> parse_csv(const std::string& text) {
    std::vector<std::vector<std::string>> rows(1);
    std::string field;
    bool quoted = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted) {
            if (c != '"')
                field += c;
            else if (i + 1 < text.size() && text[i + 1] == '"')
                field += text[++i];
            else
                quoted = false;
        } else if (c == '"' && field.empty()) {
            quoted = true;
        } else if (c == ',') {
            rows.back().push_back(std::move(field));
            field.clear();
        } else if (c == '\r' && i + 1 < text.size() && text[i + 1] == '\n') {
            rows.back().push_back(std::move(field));
            field.clear();
            rows.emplace_back();
            ++i;
        } else {
            field += c;
        }
    }
    EXPECT_TRUE(rows.back().empty() && field.empty());
    rows.pop_back();
    return rows;
}

TEST(Csv, HasOneValuePerColumnAndAgreesWithJson) {
    const BenchReport report = sample();
    const auto rows = parse_csv(bench_csv(report));
    const Json list = Json::parse(bench_json(report));
    ASSERT_EQ(rows.size(), 1 + report.records.size());
    for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
    const auto cell = [&](size_t record, const std::string& column) {
        const auto at = std::find(rows[0].begin(), rows[0].end(), column);
        EXPECT_NE(at, rows[0].end()) << column;
        return at == rows[0].end() ? std::string() : rows[1 + record][at - rows[0].begin()];
    };
    EXPECT_EQ(cell(0, "device"), "a device, \"quoted\"");
    EXPECT_EQ(cell(0, "case"), "one/4 steps");
    EXPECT_EQ(std::stod(cell(1, "time_ms.median")), list[1]["time_ms"]["median"].get<double>());
    EXPECT_EQ(std::stod(cell(2, "analysis.lanes_alive")), 0.6);
    EXPECT_EQ(cell(0, "analysis.lanes_alive"), "");
    EXPECT_EQ(cell(0, "kernels_ms"), "trace 10; tone map 0.5");
    EXPECT_EQ(cell(4, "time_ms.median"), "");
    EXPECT_EQ(std::stod(cell(0, "run.clock_mhz.before")), 2600.5);
    for (const std::string& column : rows[0]) EXPECT_EQ(std::count(rows[0].begin(), rows[0].end(), column), 1) << column;
}

TEST(Table, FitsATerminalAndShowsTheFigures) {
    BenchReport report = sample();
    report.notes = {"something was left out"};
    report.records.push_back(frame_record("a_scene_with_a_name_that_no_terminal_is_wide_enough_for_in_full", "now", 1e-3));
    report.records.back().device = "Some Device With A Long Name Of Its Own, As Vendors Like Them";
    const std::string text = bench_table(report);
    std::stringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (line.find("REFUSED") == std::string::npos) {
            EXPECT_LE(line.size(), 120u) << line;
        }
    EXPECT_NE(text.find("10.0"), std::string::npos) << text;  // column "x then": (100 + 1) / (10 + 1) = 9.18
    EXPECT_NE(text.find("9.18"), std::string::npos) << text;
    EXPECT_NE(text.find("REFUSED  accel bunny/diffuse, unsteady"), std::string::npos) << text;
    EXPECT_NE(text.find("left out  something"), std::string::npos) << text;
    EXPECT_NE(text.find("55.5"), std::string::npos) << text;
}

TEST(Table, ListsUnsteadyRowsOfACaseTogetherWithTheirSpreads) {
    BenchReport report = sample();
    for (int i = 0; i < 12; ++i) {
        BenchRecord wild = ray_record();
        wild.status = RowStatus::refused;
        wild.variant = "wild" + std::to_string(i);
        wild.time_ms = {10, 9, 12.5, 5, 20, 9};
        report.records.push_back(wild);
    }
    const std::string text = bench_table(report);
    EXPECT_NE(text.find("REFUSED  accel bunny/diffuse: wild0 35.0 %, wild1 35.0 %"), std::string::npos) << text;
    EXPECT_NE(text.find("--max-spread"), std::string::npos) << text;
    std::stringstream lines(text);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 120u) << line;
}

TEST(Table, AnEmptyReportGivesEmptyOutput) {
    EXPECT_EQ(bench_table(BenchReport{}), "");
    EXPECT_EQ(bench_json(BenchReport{}), "[]\n");
    EXPECT_TRUE(read_bench_json("[]").records.empty());
}

TEST(Report, RefusedAndFailedRowsAreNotOkButSkippedRowsAre) {
    BenchReport report;
    EXPECT_TRUE(all_ok(report));
    report.records.resize(1);
    report.records[0].status = RowStatus::skipped;
    EXPECT_TRUE(all_ok(report));
    report.records[0].status = RowStatus::refused;
    EXPECT_FALSE(all_ok(report));
    report.records[0].status = RowStatus::failed;
    EXPECT_FALSE(all_ok(report));
    report.records[0].status = RowStatus::ok;
    EXPECT_TRUE(all_ok(report));
    report.failure = "not enough memory";
    EXPECT_FALSE(all_ok(report));
}

// Checks that `now` contains every value of `before` which is not null.
void expect_kept(const Json& before, const Json& now, const std::string& path) {
    if (before.is_null()) return;
    if (before.is_object()) {
        for (const auto& [key, value] : before.items()) {
            ASSERT_TRUE(now.contains(key)) << path << "/" << key;
            expect_kept(value, now[key], path + "/" + key);
        }
    } else if (before.is_array()) {
        ASSERT_EQ(before.size(), now.size()) << path;
        for (size_t i = 0; i < before.size(); ++i) expect_kept(before[i], now[i], path + "/" + std::to_string(i));
    } else {
        EXPECT_EQ(before, now) << path;
    }
}

// Records which `clarity bench` 0.1.0 wrote: a build, rays, a frame, a breakdown, pictures of two devices, a refused row; three
// runs.
std::string old_records() {
    std::ifstream file(CLARITY_SOURCE_DIR "/tests/tools/bench/data/record_of_0_1_0.json");
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Json, RecordsOfEarlierVersionsLoad) {
    const std::string text = old_records();
    const BenchReport report = read_bench_json(text);
    ASSERT_EQ(report.records.size(), 7u);
    EXPECT_EQ(report.joined.size(), 2u);
    EXPECT_EQ(report.records[1].measure, "primary");
    EXPECT_GT(report.records[1].time_ms.median, 0);
    EXPECT_TRUE(report.records[1].analysis.present);
    EXPECT_GT(report.records[5].speedup.ratio, 1);
    EXPECT_GT(report.records[6].time_ms.spread(), 0);
    const std::string now = bench_json(report);
    expect_kept(Json::parse(text), Json::parse(now), "");
    EXPECT_EQ(bench_json(read_bench_json(now)), now);
    EXPECT_NE(bench_table(report).find("REFUSED  quick tetrahedron/primary"), std::string::npos);
    EXPECT_EQ(bench_csv(report).find("nan"), std::string::npos);
}

TEST(Json, PercentilesAreP50P95P99AndTheMedianKeyStays) {
    BenchReport report = sample();
    report.records[0].time_ms = summarize({1, 2, 3, 4, 5});
    const Json time = Json::parse(bench_json(report))[0]["time_ms"];
    EXPECT_EQ(time["p50"], 3);
    EXPECT_EQ(time["median"], 3);
    EXPECT_EQ(time["p95"], 4.8);
    EXPECT_EQ(time["p99"], 4.96);
    const BenchReport read = read_bench_json(bench_json(report));
    EXPECT_EQ(read.records[0].time_ms.p99, 4.96);
    const std::string csv = bench_csv(report), table = bench_table(report);
    for (const char* name : {"time_ms.p50", "time_ms.p95", "wall_ms.p99", "time_ms.median"})
        EXPECT_NE(csv.find(name), std::string::npos) << name;
    for (const char* name : {"p50", "p95", "p99"}) EXPECT_NE(table.find(name), std::string::npos) << table;
}

TEST(RowsFile, HoldsEveryRowAtOnceAndIsWholeAfterAFailure) {
    const Scratch scratch;
    const std::string path = scratch.path("a.json");
    BenchReport all = sample(), so_far = all;
    so_far.records.clear();
    try {
        RowsFile file(path);
        for (const BenchRecord& record : all.records) {
            so_far.records.push_back(record);
            file.add(so_far);
            // The state after a kill: all rows are in a temporary file beside the requested one.
            EXPECT_FALSE(std::filesystem::exists(path));
            const auto entry = *std::filesystem::directory_iterator(scratch.path(""));
            EXPECT_EQ(read_bench_json(scratch.read(entry.path().filename().string())).records.size(), so_far.records.size());
        }
        throw std::bad_alloc();
    } catch (const std::bad_alloc&) {
    }
    EXPECT_EQ(Json::parse(scratch.read("a.json")).size(), all.records.size());
    EXPECT_EQ(bench_json(read_bench_json(scratch.read("a.json"))), bench_json(all));
}

TEST(RowsFile, IsTheWholeReportOnceItIsFinished) {
    const Scratch scratch;
    BenchReport report = sample();
    {
        RowsFile file(scratch.path("a.json"));
        file.add(report);
        report.run.seconds = 12;
        file.finish(report);
    }
    EXPECT_EQ(scratch.read("a.json"), bench_json(report));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(scratch.path("")), {}), 1);
    {
        RowsFile untouched(scratch.path("b.json"));
    }
    EXPECT_FALSE(std::filesystem::exists(scratch.path("b.json")));
}

}  // namespace
