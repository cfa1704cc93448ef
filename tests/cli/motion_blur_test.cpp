// motion_blur_test.cpp -- `clarity render` with a shutter, and with a camera that follows a path: which bytes are in the files.
#include <gtest/gtest.h>

#include "cli/run_program.hpp"
#include "support/scratch.hpp"

namespace {

class BlurredFrames : public ::testing::Test {
 protected:
    void SetUp() override {
        if (run_program({"devices"}).exit_code == 3) GTEST_SKIP() << "no OpenCL device on this machine";
        scratch_.write("box.obj", "v -.5 -.5 0\nv .5 -.5 0\nv .5 .5 0\nv -.5 .5 0\nf 1 2 3 4\n");
        scene_ = scratch_.write("moving.scene",
                                "camera main eye 0 0 9 target 0 0 0 fov 40\nlight point position 0 0 6 name lamp\n"
                                "load box.obj name box\nanimate box translate 0 -2 0 0  1 2 0 0\n"
                                "animate lamp translate 0 -4 2 6  1 4 2 6\n");
    }
    // The bytes of a picture, or of one of numbered pictures.
    std::string render(std::vector<std::string> options, const std::string& output = "one.pfm", const std::string& read = {}) {
        std::vector<std::string> words = {"render", scene_, "--size", "48x36", "-o", scratch_.path(output)};
        words.insert(words.end(), options.begin(), options.end());
        const ProgramResult result = run_program(words);
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return scratch_.read(read.empty() ? output : read);
    }
    Scratch scratch_;
    std::string scene_;
};

TEST_F(BlurredFrames, OffIsAsBeforeAndOneSampleIsNotBlurred) {
    const std::string plain = render({"--time", "0.5", "--spp", "4"});
    EXPECT_EQ(plain, render({"--time", "0.5", "--spp", "4", "--shutter", "0"}));
    EXPECT_NE(plain, render({"--time", "0.5", "--spp", "4", "--shutter", "0.5", "--fps", "2"}));
    EXPECT_EQ(render({"--time", "0.5"}), render({"--time", "0.5", "--shutter", "1", "--fps", "2"}));
}

// Frames depend on their numbers alone: in a range, backwards, one by one, and as --time shows them.
TEST_F(BlurredFrames, LookTheSameInAnyOrder) {
    const std::vector<std::string> blur = {"--spp", "6", "--set", "shutter=0.8", "--fps", "4"};
    const auto frames = [&](const std::string& range, const std::string& name, const std::string& read) {
        std::vector<std::string> words = blur;
        words.insert(words.end(), {"--frames", range});
        return render(words, name, read);
    };
    const std::string second = frames("1-3", "a_#.pfm", "a_2.pfm");
    EXPECT_EQ(second, frames("2", "b_#.pfm", "b_2.pfm"));
    EXPECT_EQ(second, frames("0-2/2", "c_#.pfm", "c_2.pfm"));
    std::vector<std::string> time = blur;
    time.insert(time.end(), {"--time", "0.5"});
    EXPECT_EQ(second, render(time));
    EXPECT_NE(second, scratch_.read("a_3.pfm"));
}

// What the user hides or moves out of the picture is so in every sample.
TEST_F(BlurredFrames, EditsHoldForAllSamples) {
    const std::vector<std::string> plain = {"--time", "0.5", "--spp", "4"},
                                   blurred = {"--time", "0.5", "--spp", "4", "--shutter", "1", "--fps", "2"};
    const auto with = [&](std::vector<std::string> words, const std::string& edit) {
        words.insert(words.end(), {"--set", edit});
        return render(words);
    };
    const std::string nothing = with(plain, "hide=0");
    EXPECT_NE(nothing, render(plain));
    EXPECT_EQ(nothing, with(blurred, "hide=0"));
    EXPECT_EQ(nothing, with(blurred, "instance.0.translate=0,100,0"));
}

// A scene that does not move has times where its camera does.
TEST_F(BlurredFrames, ACameraFollowsItsPath) {
    scene_ = scratch_.write("still.scene", "camera main eye 0 1 6\nlight point position 3 6 4\nplane\nsphere center 0 1 0\n");
    const std::string path = "camera_path=0:0,1,6,0,1,0,45,0,1,0;1:2,1,6,2,1,0,45,0,1,0";
    const std::string begin = render({"--set", "camera=0,1,6,0,1,0,45,0,1,0"}),
                      middle = render({"--set", "camera=1,1,6,1,1,0,45,0,1,0"});
    EXPECT_EQ(begin, render({"--set", path, "--frames", "0-4/2", "--fps", "4"}, "f_#.pfm", "f_0.pfm"));
    EXPECT_EQ(middle, scratch_.read("f_2.pfm"));
    EXPECT_EQ(middle, render({"--set", path, "--time", "0.5"}));
    EXPECT_EQ(middle, render({"--set", path, "--time", "0.2", "--set", "camera=1,1,6,1,1,0,45,0,1,0"}))
        << "set behind the path";
    EXPECT_NE(render({"--set", path, "--time", "0.5", "--spp", "8", "--shutter", "1", "--fps", "2"}),
              render({"--set", path, "--time", "0.5", "--spp", "8"}));
    EXPECT_EQ(run_program({"render", scene_, "--set", "camera_path=0:1", "-o", scratch_.path("x.pfm")}).exit_code, 2);
}

}  // namespace
