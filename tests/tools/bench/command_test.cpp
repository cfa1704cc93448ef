// command_test.cpp -- `clarity bench` as a user runs it. Tests do not depend on times: --max-spread has its largest value.
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>

#include "cli/run_program.hpp"
#include "support/clock.hpp"

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class BenchCommand : public testing::Test {
 protected:
    BenchCommand() : folder_(fs::temp_directory_path() / ("clarity-bench-" + std::to_string(getpid()))) {
        fs::create_directories(folder_);
        std::ofstream(file("tiny.scene")) << "camera main eye 0 1 4 target 0 0.5 0\n"
                                             "light point position 3 5 2 color 1 1 1\n"
                                             "material mirror color .5 .5 .5 reflect .6\n"
                                             "polygon material mirror vertices -2 0 -2  -2 0 2  2 0 2  2 0 -2\n"
                                             "load \"tetrahedron.obj\" material mirror\n";
        std::ofstream(file("tetrahedron.obj"))
            << "v 0 1 0\nv 1 0 0\nv -1 0 0.8\nv -1 0 -0.8\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    }
    ~BenchCommand() override { fs::remove_all(folder_); }

    std::string file(const std::string& name) const { return (folder_ / name).string(); }
    ProgramResult bench(std::vector<std::string> words, RunOptions options = {}) const {
        words.insert(words.begin(), "bench");
        return run_program(words, options);
    }
    // Runs with small pictures; no row is refused as unsteady. The time limit leaves room for compiling kernels with an empty
    // cache.
    ProgramResult quick(std::vector<std::string> words, RunOptions options = {}) const {
        for (const char* word : {"--size", "64x48", "--time-limit", "600", "--max-spread", "10"}) words.push_back(word);
        return bench(words, options);
    }
    Json records(const std::string& name) const {
        std::ifstream in(file(name));
        return Json::parse(in);
    }

    const fs::path folder_;
};

TEST_F(BenchCommand, ListsEverySuiteWithoutADevice) {
    RunOptions nothing;
    nothing.environment["CLARITY_DEVICE"] = "no such device";
    for (const char* suite : {"thesis", "packets", "accel", "scale", "large", "devices", "zoo", "quick"}) {
        const ProgramResult result = bench({suite, "--list"}, nothing);
        EXPECT_EQ(result.exit_code, 0) << result.err;
        EXPECT_NE(result.out.find(suite), std::string::npos) << result.out;
        EXPECT_LT(result.seconds, clarity::test::at_most(10));
    }
    const ProgramResult thesis = bench({"thesis", "--list"});
    for (const char* name : {"1_two_triangles/1 step ", "6_2406_triangles/4 steps", "now | then"})
        EXPECT_NE(thesis.out.find(name), std::string::npos) << thesis.out;
    const ProgramResult large = bench({"large", "--list", "--max-triangles", "100000000"});
    for (const char* name : {"near_1M/build", "near_10M/diffuse", "near_100M/frame", "bvh4 | cwbvh"})
        EXPECT_NE(large.out.find(name), std::string::npos) << large.out;
    EXPECT_EQ(bench({"large", "--list"}).out.find("near_100M/"), std::string::npos);
}

TEST_F(BenchCommand, BothNamesOfTheOptionLeaveBaselinesOut) {
    EXPECT_NE(bench({"quick", file("tetrahedron.obj"), "--list"}).out.find("| peers "), std::string::npos);
    for (const char* option : {"--no-peers", "--no-baselines"}) {
        const ProgramResult result = bench({"quick", file("tetrahedron.obj"), "--list", option});
        EXPECT_EQ(result.exit_code, 0) << result.err;
        EXPECT_EQ(result.out.find("| peers "), std::string::npos) << option;
    }
}

TEST_F(BenchCommand, MeasuresASceneAndWritesEverything) {
    const ProgramResult result = quick({file("tiny.scene"), "--accel", "bvh2", "--accel", "bvh2,max_leaf=1", "--json",
                                        file("a.json"), "--csv", file("a.csv"), "--report", file("page")});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find("bvh2"), std::string::npos) << result.out;
    const bool with_embree = result.err.find("without Embree") == std::string::npos;
    EXPECT_EQ(result.err.find("tiny: peers are left out: they trace triangles only") != std::string::npos, with_embree)
        << result.err;
    const Json list = records("a.json");
    ASSERT_TRUE(list.is_array());
    size_t frames = 0, rays = 0, builds = 0, dropped = 0;
    for (const Json& record : list) {
        EXPECT_EQ(record["scene"], "tiny");
        if (record["status"] == "skipped") continue;
        ASSERT_EQ(record["status"], "ok") << record.dump();
        const std::string measure = record["measure"];
        if (measure == "frame") {
            ++frames;
            EXPECT_GT(record["fps"], 0);
            EXPECT_GE(record["frame_ms"]["n"], 3);
            EXPECT_EQ(record["rays"]["primary"], 64 * 48);
            EXPECT_GT(record["rays"]["secondary"], 100);
            EXPECT_LE(record["frame_ms"]["median"].get<double>(), record["wall_ms"]["median"].get<double>());
        } else if (measure == "build") {
            ++builds;
        } else if (measure == "dropped") {
            ++dropped;
        } else {
            ++rays;
            EXPECT_GT(record["mrays_per_s"], 0) << record.dump();
            EXPECT_GT(
                record["analysis"]["nodes_per_ray"].get<double>() + record["analysis"]["leaf_tests_per_ray"].get<double>(), 0);
        }
    }
    EXPECT_EQ(frames, 2u);
    EXPECT_EQ(builds, 2u);
    EXPECT_EQ(rays, 8u);
    EXPECT_EQ(dropped, 4u);
    std::ifstream csv(file("a.csv"));
    std::string line;
    size_t lines = 0;
    while (std::getline(csv, line)) ++lines;
    EXPECT_EQ(lines, 1 + list.size());
    EXPECT_TRUE(fs::exists(file("page/index.html")));

    // Joins a file with itself; nothing is measured.
    const ProgramResult joined = bench({"--join", file("a.json"), "--join", file("a.json"), "--json", "-"});
    EXPECT_EQ(joined.exit_code, 0) << joined.err;
    EXPECT_EQ(Json::parse(joined.out).size(), 2 * list.size());
}

TEST_F(BenchCommand, BaselinesAreMeasuredIfTheSceneIsOnlyTriangles) {
    const ProgramResult result = quick({file("tetrahedron.obj"), "--accel", "bvh2", "--json", file("a.json")});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    size_t baselines = 0, ours = 0;
    for (const Json& record : records("a.json")) (record["peer"].is_null() ? ours : baselines) += record["status"] == "ok";
    EXPECT_GE(ours, 6u);
    const size_t expected = result.err.find("without Embree") == std::string::npos ? 3 + 4 * 9 : 0;
    EXPECT_EQ(baselines, expected) << result.out;
    std::string version;
    for (const Json& record : records("a.json")) {
        if (record["peer"].is_null()) continue;
        version = record["driver"];
        EXPECT_TRUE(std::regex_match(version, std::regex("Embree [34]\\.[0-9]+\\.[0-9]+"))) << version;
    }
    if (expected) {
        EXPECT_NE(result.out.find("peers: " + version + "\n"), std::string::npos) << result.out;
    }
    const ProgramResult alone = quick({file("tetrahedron.obj"), "--accel", "bvh2", "--no-peers", "--json", file("b.json")});
    ASSERT_EQ(alone.exit_code, 0) << alone.err;
    for (const Json& record : records("b.json")) EXPECT_TRUE(record["peer"].is_null());
}

TEST_F(BenchCommand, DevicesShareAPicture) {
    const ProgramResult result =
        quick({"devices", file("tiny.scene"), "--device", "cpu/2", "--accel", "bvh2", "--spp", "2", "--json", file("a.json")});
    if (result.exit_code == 3) GTEST_SKIP() << "NOT TESTED: " << result.err;
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Json list = records("a.json");
    ASSERT_EQ(list.size(), 2u);
    for (const Json& record : list) {
        EXPECT_EQ(record["measure"], "picture");
        ASSERT_EQ(record["status"], "ok") << record.dump();
        EXPECT_EQ(record["rays"]["primary"], 64 * 48 * 2);
        EXPECT_GT(record["fps"], 0);
    }
    EXPECT_EQ(list[0]["variant"], "bvh2, 1 device");
    EXPECT_EQ(list[1]["variant"], "bvh2, 2 devices");
    EXPECT_EQ(list[0]["rays"], list[1]["rays"]);
    EXPECT_EQ(list[1]["threads"], list[0]["threads"].get<int>() * 2);
    EXPECT_TRUE(list[0]["versus"].is_null());
    EXPECT_GT(list[1]["versus"]["ratio"], 0) << "speed-up over one device";
    EXPECT_NE(result.out.find("x the first"), std::string::npos) << result.out;
}

// On a CPU: rays in a second of one processor.
TEST_F(BenchCommand, TimesAreOfProcessorsIfAskedFor) {
    const ProgramResult result = quick({file("tetrahedron.obj"), "--device", "cpu", "--accel", "bvh2", "--no-peers", "--only",
                                        "/primary", "--only", "/build", "--processor-time", "--json", file("a.json")});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Json list = records("a.json");
    ASSERT_EQ(list.size(), 2u);
    for (const Json& record : list) {
        EXPECT_EQ(record["clock"], "processor") << record.dump();
        EXPECT_TRUE(record["wall_ms"].is_null());
        EXPECT_GT(record["time_ms"]["p50"], 0);
    }
    const double ms = list[1]["time_ms"]["p50"], rays = list[1]["rays"]["primary"];
    EXPECT_NEAR(list[1]["mrays_per_s"].get<double>() * ms * 1000 / rays, 1, 1e-3);
    EXPECT_NE(result.out.find("times by processors"), std::string::npos) << result.out;
}

TEST_F(BenchCommand, RunsOnceWithEachNumberOfThreads) {
    const ProgramResult result = quick({file("tetrahedron.obj"), "--device", "cpu", "--accel", "bvh2", "--no-peers", "--only",
                                        "/primary", "--threads", "1,2", "--json", file("a.json")});
    if (result.err.find("name no more") != std::string::npos) GTEST_SKIP() << "NOT TESTED: " << result.err;
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Json list = records("a.json");
    ASSERT_EQ(list.size(), 2u);
    for (unsigned i = 0; i < 2; ++i) {
        EXPECT_EQ(list[i]["threads"], i + 1);
        EXPECT_EQ(list[i]["run"]["host_threads"], i + 1) << list[i].dump();
    }
    EXPECT_NE(result.out.find("x by 2"), std::string::npos) << result.out;
    const ProgramResult many = quick({file("tetrahedron.obj"), "--threads", "1024"});
    EXPECT_EQ(many.exit_code, 2);
    EXPECT_NE(many.err.find("--threads 1024: this process may use"), std::string::npos) << many.err;
}

TEST_F(BenchCommand, UnsteadyRowsAreRefusedWithAMessage) {
    const ProgramResult result = bench({file("tetrahedron.obj"), "--accel", "bvh2", "--no-peers", "--size", "64x48",
                                        "--time-limit", "60", "--max-spread", "0", "--json", file("a.json")});
    EXPECT_EQ(result.exit_code, 1) << result.out;
    EXPECT_NE(result.out.find("REFUSED"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("--max-spread"), std::string::npos) << result.out;
    bool refused = false;
    for (const Json& record : records("a.json")) {
        if (record["status"] != "refused") continue;
        refused = true;
        EXPECT_TRUE(record["mrays_per_s"].is_null());
    }
    EXPECT_TRUE(refused);
}

TEST_F(BenchCommand, AnInterruptKeepsCompleteRows) {
    RunOptions options;
    options.signal = SIGINT;
    options.signal_when = "2/7 accel";
    const ProgramResult result = bench({file("tiny.scene"), "--accel", "bvh2", "--accel", "bvh2,max_leaf=1", "--size",
                                        "512x384", "--max-spread", "10", "--time-limit", "60", "--json", file("a.json")},
                                       options);
    EXPECT_EQ(result.exit_code, 130) << result.err;
    const Json list = records("a.json");
    EXPECT_GE(list.size(), 2u);
    EXPECT_LT(list.size(), 14u);
}

TEST_F(BenchCommand, UnknownOptionsAndValuesAreUsageErrors) {
    std::ofstream(file("broken.json")) << "[{\"status\": 3}]";
    const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
        {{}, "name a suite"},
        {{"fastest"}, "no such suite"},
        {{"quick", "--set", "lanes"}, "key=value"},
        {{"quick", "--set", "nonsense=1"}, "nonsense"},
        {{"quick", "--accel", "no_such_tree"}, "no_such_tree"},
        {{"quick", "--accel", "bvh2,max_leaf=0"}, "max_leaf"},
        {{"quick", "--aov", "t"}, "colour only"},
        {{"quick", "--spp", "4"}, "one sample"},
        {{"quick", "--max-spread", "-1"}, "--max-spread"},
        {{"quick", "--json", file("nowhere/a.json")}, "nowhere"},
        {{"quick", "--report", file("tiny.scene") + "/page"}, "--report"},
        {{"quick", "--join", file("broken.json")}, "record 0"},
        {{"quick", "--join", file("missing.json")}, "cannot be read"},
    };
    for (const auto& [words, expected] : cases) {
        const ProgramResult result = bench(words);
        EXPECT_EQ(result.exit_code, 2) << result.err;
        EXPECT_NE(result.err.find(expected), std::string::npos) << expected << ": " << result.err;
        EXPECT_EQ(result.out, "");
    }
}

TEST_F(BenchCommand, ScenesThatCannotBeReadAreImportErrors) {
    std::ofstream(file("broken.obj")) << "f 1 2 3\n";
    for (const std::string& name : {file("missing.obj"), file("broken.obj")}) {
        const ProgramResult result = quick({name});
        EXPECT_EQ(result.exit_code, 4) << result.err;
        EXPECT_NE(result.err.find(name), std::string::npos) << result.err;
    }
    // Rows of the other scene are kept.
    const ProgramResult mixed =
        quick({file("broken.obj"), file("tetrahedron.obj"), "--accel", "bvh2", "--no-peers", "--json", file("a.json")});
    EXPECT_EQ(mixed.exit_code, 1) << mixed.err;
    EXPECT_NE(mixed.out.find("FAILED  accel broken/build"), std::string::npos) << mixed.out;
    EXPECT_GE(records("a.json").size(), 7u);
    RunOptions nothing;
    nothing.environment["CLARITY_DEVICE"] = "no such device";
    EXPECT_EQ(quick({file("tiny.scene")}, nothing).exit_code, 3);
}

}  // namespace
