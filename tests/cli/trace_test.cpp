// trace_test.cpp -- `clarity trace`: rays by their numbers, and what they hit.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "cli/run_program.hpp"
#include "support/scratch.hpp"

namespace {

class Trace : public ::testing::Test {
 protected:
    void SetUp() override {
        scene_ = scratch_.write("a.scene", "sphere center 0 0 0 radius 1\nsphere center 0 0 -5 radius 1\n");
    }
    // Hits of the rays in `text`, a vector of numbers a line.
    std::vector<std::vector<double>> hits(const std::string& text, const std::vector<std::string>& more = {}) {
        std::vector<std::string> words = {"trace", scene_, "--rays", scratch_.write("rays.txt", text), "-o", "-"};
        words.insert(words.end(), more.begin(), more.end());
        const ProgramResult result = run_program(words);
        EXPECT_EQ(result.exit_code, 0) << result.err;
        std::vector<std::vector<double>> rows;
        std::istringstream lines(result.out);
        for (std::string line; std::getline(lines, line);) {
            if (line.empty() || line[0] == '#') continue;
            rows.emplace_back();
            std::istringstream numbers(line);
            for (std::string word; numbers >> word;) rows.back().push_back(std::stod(word));
        }
        return rows;
    }
    std::string complaint(const std::string& text) {
        const std::string file = scratch_.write("bad.txt", text);
        const ProgramResult result = run_program({"trace", scene_, "--rays", file, "-o", "-"});
        EXPECT_EQ(result.exit_code, 2) << result.out << result.err;
        EXPECT_NE(result.err.find(file), std::string::npos) << result.err;
        return result.err;
    }
    Scratch scratch_;
    std::string scene_;
};

TEST_F(Trace, BadRaysAreNamedByLineAndColumn) {
    EXPECT_NE(complaint("# a comment\n0 0 5 0 0 0 -1\n").find(":2:15: the line ends after 7 numbers, expected t_max"),
              std::string::npos)
        << complaint("# a comment\n0 0 5 0 0 0 -1\n");
    EXPECT_NE(complaint("0 0 5 0 0 zero -1 inf").find(":1:11: found 'zero', expected a number (direction y)"),
              std::string::npos);
    EXPECT_NE(complaint("0 0 5 0 0 0 -1 inf 7").find(":1:20: a ninth number '7'"), std::string::npos);
    EXPECT_NE(complaint("0 0 5 0 0 0 -1 1e99").find(":1:16: '1e99' is beyond the range of a float"), std::string::npos);
}

TEST_F(Trace, AnswersRays) {
    if (run_program({"devices"}).exit_code == 3) GTEST_SKIP() << "no OpenCL device on this machine";
    const std::string rays =
        "# origin, t_min, direction, t_max\n"
        "0 0 5  0   0 0 -1  inf\n"
        "0,0,5, 4.5, 0,0,-1, inf   # begins within the first sphere\n"
        "\n"
        "0 0 5  0   0 0 -1  3.5\n"
        "0 3 5  0   0 0 -1  inf\n";
    for (const char* lanes : {"1", "4"}) {
        const auto rows = hits(rays, {"--accel", "linear", "--lanes", lanes});
        ASSERT_EQ(rows.size(), 4u);
        EXPECT_NEAR(rows[0][0], 4, 1e-5);
        EXPECT_EQ(rows[0][1], 0);
        EXPECT_EQ(rows[0][2], -1) << "not instanced";
        EXPECT_NEAR(rows[1][0], 6, 1e-5) << "its far side";
        EXPECT_TRUE(std::isinf(rows[2][0]));
        EXPECT_EQ(rows[2][1], -1);
        EXPECT_TRUE(std::isinf(rows[3][0]));
    }
    const auto any = hits(rays, {"--accel", "linear", "--any"});
    EXPECT_EQ(any, (std::vector<std::vector<double>>{{1}, {1}, {0}, {0}}));
}

TEST_F(Trace, ListsAllHits) {
    if (run_program({"devices"}).exit_code == 3) GTEST_SKIP() << "no OpenCL device on this machine";
    const std::string rays = "0 0 5 0 0 0 -1 inf\n0 3 5 0 0 0 -1 inf\n0 0 5 4.5 0 0 -1 inf\n";
    const auto all = hits(rays, {"--accel", "linear", "--all"});
    ASSERT_EQ(all.size(), 7u);
    const double expected[7][3] = {{0, 4, 0}, {0, 6, 0}, {0, 9, 1}, {0, 11, 1}, {2, 6, 0}, {2, 9, 1}, {2, 11, 1}};
    for (size_t i = 0; i < 7; ++i) {
        ASSERT_EQ(all[i].size(), 6u);
        EXPECT_EQ(all[i][0], expected[i][0]) << "the ray of hit " << i;
        EXPECT_NEAR(all[i][1], expected[i][1], 1e-5) << "t of hit " << i;
        EXPECT_EQ(all[i][2], expected[i][2]) << "prim of hit " << i;
    }
    EXPECT_EQ(hits(rays, {"--accel", "linear", "--count"}), (std::vector<std::vector<double>>{{4}, {0}, {3}}));
    const ProgramResult both = run_program({"trace", scene_, "--rays", scratch_.path("rays.txt"), "-o", "-", "--all", "--any"});
    EXPECT_EQ(both.exit_code, 2) << both.err;
}

TEST_F(Trace, WritesAFile) {
    if (run_program({"devices"}).exit_code == 3) GTEST_SKIP() << "no OpenCL device on this machine";
    const std::string file = scratch_.path("hits.txt");
    const ProgramResult result =
        run_program({"trace", scene_, "--rays", scratch_.write("r", "0 0 5 0 0 0 -1 inf\n"), "-o", file, "--accel", "linear"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(scratch_.read("hits.txt").substr(0, 22), "# t prim instance u v\n");
}

}  // namespace
