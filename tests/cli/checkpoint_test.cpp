// checkpoint_test.cpp -- pictures that go on after their process was ended, with the bits that they would have had.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>

#include "cli/run_program.hpp"
#include "support/scratch.hpp"

namespace fs = std::filesystem;

namespace {

class CheckpointedPictures : public ::testing::Test {
 protected:
    void SetUp() override {
        if (run_program({"devices"}).exit_code == 3) GTEST_SKIP() << "no OpenCL device on this machine";
        scratch_.write("cube.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        scratch_.write("a.scene",
                       "camera main eye 0 1 6 target 0 1 0 fov 40\nlight point position 3 6 4\n"
                       "material mirror color .2 .2 .2 reflect .8\nplane normal 0 1 0 offset 0\n"
                       "sphere center 0 1 0 radius 1 material mirror\nload cube.obj name car\n"
                       "animate car translate 0 0 0 0  2 1 0 0\n");
        fs::create_directory(scratch_.path("out"));
    }

    std::string out(const std::string& name) const { return scratch_.path("out/" + name); }
    std::vector<std::string> files() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(scratch_.path("out")))
            names.push_back(entry.path().filename().string());
        std::sort(names.begin(), names.end());
        return names;
    }
    ProgramResult render(const std::string& output, const std::vector<std::string>& more,
                         const RunOptions& options = {}) const {
        std::vector<std::string> all = {"render", scratch_.path("a.scene"), "-o", out(output), "--size", "240x180", "--spp",
                                        "1200"};
        all.insert(all.end(), more.begin(), more.end());
        return run_program(all, options);
    }
    std::string read(const std::string& name) const { return scratch_.read("out/" + name); }

    Scratch scratch_;
};

}  // namespace

TEST_F(CheckpointedPictures, GoOnAfterASignal) {
    ASSERT_EQ(render("whole.pfm", {}).exit_code, 0);
    RunOptions options;
    options.signal = SIGTERM;
    options.signal_when = "samples";  // of the first checkpoint
    ProgramResult result = render("a.pfm", {"--checkpoint", out("a.ckpt"), "--every", "0.2", "-v"}, options);
    ASSERT_EQ(result.exit_code, 130) << result.err;
    EXPECT_EQ(files(), (std::vector<std::string>{"a.ckpt", "whole.pfm"})) << "no picture that is not whole";
    EXPECT_NE(result.err.find("of 1200 samples a pixel; the same command with --resume"), std::string::npos) << result.err;
    // Of another picture, or of none.
    result = render("b.pfm", {"--resume", out("a.ckpt"), "--depth", "2"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.err.find("a.ckpt: is a checkpoint of another picture"), std::string::npos) << result.err;
    result = render("b.pfm", {"--resume", out("whole.pfm")});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.err.find("a file of another kind"), std::string::npos) << result.err;
    EXPECT_EQ(files(), (std::vector<std::string>{"a.ckpt", "whole.pfm"}));
    result = render("a.pfm", {"--resume", out("a.ckpt")});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.err.find("goes on after"), std::string::npos) << result.err;
    EXPECT_EQ(read("a.pfm"), read("whole.pfm"));
    EXPECT_EQ(files(), (std::vector<std::string>{"a.pfm", "whole.pfm"})) << "the checkpoint of a complete picture goes";
}

TEST_F(CheckpointedPictures, OptionsThatDoNotFit) {
    const auto refused = [&](const std::vector<std::string>& more, const std::string& word) {
        const ProgramResult result = render("x_.png", more);
        EXPECT_EQ(result.exit_code, 2) << result.err;
        EXPECT_NE(result.err.find(word), std::string::npos) << result.err;
    };
    refused({"--checkpoint", out("c"), "--repeat", "2"}, "--repeat");
    refused({"--checkpoint", out("c"), "--aov", "t"}, "--aov t");
    refused({"--checkpoint", out("c"), "--watch"}, "--watch");
    refused({"--checkpoint", out("no/folder/c")}, "no/folder");
    refused({"--checkpoint", out("x_.png")}, "same file");
    refused({"--checkpoint", out("c"), "-o", out("f_#.png"), "--frames", "1-2"}, "####");
    const ProgramResult missing = render("x.png", {"--checkpoint", out("c"), "--resume", out("d")});
    EXPECT_EQ(missing.exit_code, 1);
    EXPECT_NE(missing.err.find("d: no checkpoint to go on from: No such file"), std::string::npos) << missing.err;
    EXPECT_TRUE(files().empty());
}

// The command that a scheduler starts again and again.
TEST_F(CheckpointedPictures, GoOnAfterManyKills) {
    const std::string spp = "5000";  // seconds on any machine, so that several kills come in time
    ASSERT_EQ(render("whole.pfm", {"--spp", spp}).exit_code, 0);
    RunOptions options;
    options.signal = SIGKILL;
    int kills = 0;
    for (ProgramResult result;; ++kills) {
        ASSERT_LT(kills, 60) << result.err;
        // Not before the first checkpoint, and ever later, so that a slow machine comes to the end, too.
        options.signal_when = "samples";
        options.signal_after_s = 0.7 + 0.07 * (kills % 9) + 0.01 * kills * kills;
        const bool two = kills % 2 == 1;  // on two devices, every other time
        result = render("a.pfm",
                        {"--spp", spp, "--resume", out("a.ckpt"), "--every", "0.05", "-v", "--device", two ? "cpu/2" : "cpu"},
                        options);
        if (result.exit_code == 0) break;
        ASSERT_EQ(result.exit_code, 128 + SIGKILL) << result.err;
        EXPECT_FALSE(fs::exists(out("a.pfm")));
    }
    EXPECT_GT(kills, 1);
    EXPECT_EQ(read("a.pfm"), read("whole.pfm"));
    EXPECT_EQ(files(), (std::vector<std::string>{"a.pfm", "whole.pfm"}));
}

// Samples at times of their own, in frames with a checkpoint each.
TEST_F(CheckpointedPictures, GoOnInMotionBlur) {
    const std::vector<std::string> frames = {"--frames", "5-6", "--shutter", "0.5", "--spp", "300"};
    ASSERT_EQ(render("whole_#.pfm", frames).exit_code, 0);
    std::vector<std::string> more = frames;
    more.insert(more.end(), {"--resume", out("c_#.ckpt"), "--every", "0.1", "--skip-existing"});
    RunOptions options;
    options.signal = SIGTERM;
    int ends = 0;
    for (ProgramResult result;; ++ends) {
        ASSERT_LT(ends, 60) << result.err;
        options.signal_after_s = 1 + 0.1 * (ends % 7) + 0.02 * ends * ends;  // ever later, as above
        result = render("a_#.pfm", more, options);
        if (result.exit_code == 0) break;
    }
    for (const char* name : {"5.pfm", "6.pfm"}) EXPECT_EQ(read(std::string("a_") + name), read(std::string("whole_") + name));
    EXPECT_EQ(files(), (std::vector<std::string>{"a_5.json", "a_5.pfm", "a_6.json", "a_6.pfm", "whole_5.json", "whole_5.pfm",
                                                 "whole_6.json", "whole_6.pfm"}));
}
