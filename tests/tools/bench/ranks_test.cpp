// ranks_test.cpp -- `clarity bench mpi` with a script in the place of mpirun, which says how long its ranks took. With real
// ranks: tests/farm/ranks_share.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"
#include "support/scratch.hpp"

namespace {

using Json = nlohmann::json;

// Takes 100 ms with one rank and 60 with two; `more` may change picture, time or exit code. Logs its words.
std::string mpirun_script(const std::string& log, const std::string& more) {
    return "#!/bin/sh\necho \"$*\" >>" + log + R"(
while [ $# -gt 0 ]; do
    case $1 in
    -n) ranks=$2 ;;
    -o) picture=$2 ;;
    --stats) stats=$2 ;;
    esac
    shift
done
content=pixels
trace=$((140 - 40 * ranks))
)" + more +
           R"(
echo "$content" >"$picture"
cat >"$stats" <<END
{"accel": "bvh8", "tracer": "iterative", "depth": 4, "size": "64x48", "packet": "4x4", "lanes": 8, "triangles": 10,
 "import_ms": 1, "share_ms": 2, "prepare_ms": 3, "wait_ms": {"to_trace": 4, "traced": 5}, "collect_ms": 10,
 "ranks": [{"frame_ms": $trace, "frame_wall_ms": $trace}], "build_ms": 1, "pack_ms": 1, "compile_ms": 1, "accel_bytes": 100,
 "nodes": 5, "rays": {"primary": 1000, "shadow": 0, "secondary": 0}, "dropped_rays": 0}
END
)";
}

class BenchRanks : public ::testing::Test {
 protected:
    void SetUp() override {
        if (run_program({"devices"}).exit_code == 3) GTEST_SKIP() << "no OpenCL device on this machine";
        scratch_.write("a.scene", "camera main eye 0 0 5\nsphere center 0 0 0 radius 1\n");
        ranks("");
    }
    void ranks(const std::string& more) const {
        chmod(scratch_.write("ranks.sh", mpirun_script(scratch_.path("log"), more)).c_str(), 0755);
    }
    ProgramResult bench(const std::vector<std::string>& more, const RunOptions& options = {}) const {
        std::vector<std::string> words = {"bench",
                                          "mpi",
                                          scratch_.path("a.scene"),
                                          "--mpirun",
                                          scratch_.path("ranks.sh") + " --here",
                                          "--json",
                                          scratch_.path("a.json")};
        words.insert(words.end(), more.begin(), more.end());
        return run_program(words, options);
    }
    Json records() const { return Json::parse(scratch_.read("a.json")); }

    Scratch scratch_;
};

}  // namespace

TEST_F(BenchRanks, RowsSayHowFastAndWhereTimeGoes) {
    const ProgramResult result =
        bench({"--ranks", "1,2", "--device", "cpu", "--accel", "bvh8,max_leaf=4", "--size", "64x48", "--spp", "3"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Json list = records();
    ASSERT_EQ(list.size(), 2u);
    const Json &one = list[0], &two = list[1];
    EXPECT_EQ(one["suite"], "mpi");
    EXPECT_EQ(one["ranks"], 1);
    EXPECT_TRUE(one["efficiency"].is_null());
    EXPECT_EQ(two["variant"], "bvh8,max_leaf=4, 2 ranks");
    EXPECT_EQ(two["ranks"], 2);
    EXPECT_EQ(two["device_id"], one["device_id"]) << "both ranks use the one device";
    // 5 ms of waiting and 10 of collecting belong to the picture.
    EXPECT_EQ(one["wall_ms"]["p50"], 115);
    EXPECT_EQ(two["wall_ms"]["p50"], 75);
    EXPECT_NEAR(two["versus"]["ratio"].get<double>(), 115.0 / 75, 1e-4);
    EXPECT_NEAR(two["efficiency"].get<double>(), 115.0 / 75, 1e-4) << "of one device";
    std::vector<std::string> names;
    for (const Json& part : two["parts_ms"]) {
        names.push_back(part["part"]);
        if (names.back() == "wait") {
            EXPECT_EQ(part["ms"], 9);
        }
    }
    EXPECT_EQ(names, (std::vector<std::string>{"start", "import", "share", "build", "wait", "trace", "collect"}));
    EXPECT_NE(result.out.find("efficiency %"), std::string::npos) << result.out;
    const std::string log = scratch_.read("log");
    for (const std::string& words :
         std::vector<std::string>{"--here -n 1 ", "--here -n 2 ", " render " + scratch_.path("a.scene"), "--set spp=3",
                                  "--accel bvh8,max_leaf=4", "--mpi", "--device "})
        EXPECT_NE(log.find(words), std::string::npos) << words << "\n" << log.substr(0, 1000);
}

TEST_F(BenchRanks, OneDeviceARankCountsForTheEfficiency) {
    const ProgramResult result = bench({"--ranks", "1,2", "--device", "cpu/2"});
    if (result.exit_code == 2 || result.exit_code == 3) GTEST_SKIP() << "NOT TESTED: " << result.err;
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Json list = records();
    EXPECT_NEAR(list[1]["efficiency"].get<double>(), 115.0 / 75 / 2, 1e-4);
    EXPECT_EQ(list[1]["threads"], list[0]["threads"].get<int>() * 2);
}

TEST_F(BenchRanks, OtherBytesAreRefused) {
    ranks("[ $ranks = 2 ] && content=other");
    const ProgramResult result = bench({"--ranks", "1,2", "--device", "cpu"});
    EXPECT_EQ(result.exit_code, 1);
    const Json list = records();
    EXPECT_EQ(list[0]["status"], "ok");
    EXPECT_EQ(list[1]["status"], "refused");
    EXPECT_NE(list[1]["why"].get<std::string>().find("other bytes"), std::string::npos) << list[1];
    ranks("content=$$");
    EXPECT_EQ(bench({"--ranks", "1", "--device", "cpu"}).exit_code, 1);
    EXPECT_NE(records()[0]["why"].get<std::string>().find("from run to run"), std::string::npos) << records()[0];
}

TEST_F(BenchRanks, FailuresSayWhatRanksSaid) {
    ranks("echo 'error: no such scene' >&2; exit 4");
    const ProgramResult failed = bench({"--ranks", "2", "--device", "cpu"});
    EXPECT_EQ(failed.exit_code, 1);
    EXPECT_NE(failed.out.find("-n 2: exit code 4"), std::string::npos) << failed.out;
    EXPECT_NE(failed.out.find("no such scene"), std::string::npos) << failed.out;
    const ProgramResult none = run_program({"bench", "mpi", scratch_.path("a.scene"), "--mpirun", scratch_.path("none")});
    EXPECT_NE(none.out.find("cannot be started"), std::string::npos) << none.out;
    EXPECT_NE(none.out.find("openmpi-bin"), std::string::npos) << none.out;
}

TEST_F(BenchRanks, AnInterruptEndsTheRanks) {
    ranks("echo $$ >" + scratch_.path("pid") + "; exec sleep 600");
    RunOptions options;
    options.signal = SIGINT;
    options.signal_when_made = scratch_.path("pid");
    const ProgramResult result = bench({"--ranks", "1", "--device", "cpu"}, options);
    EXPECT_EQ(result.exit_code, 130) << result.err;
    const std::string pid = scratch_.read("pid");
    ASSERT_FALSE(pid.empty());
    EXPECT_NE(kill(std::stoi(pid), 0), 0) << "the ranks are still there";
}
