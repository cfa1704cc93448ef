// errors_test.cpp -- a kernel that does not compile: the error names file and line and has the right exit code. What worked
// before still works.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/error.hpp"
#include "support/generated.hpp"
#include "support/scenes.hpp"
#include "support/scratch.hpp"

using namespace clarity;
using namespace clarity::test;
namespace fs = std::filesystem;

namespace {

// Copies the checkout's kernels and traversals to a folder that CLARITY_KERNEL_PATH names, so that they precede the embedded
// ones.
class KernelErrors : public ::testing::Test {
 protected:
    void SetUp() override {
        fs::copy(source_file("cl"), scratch_.path("cl"), fs::copy_options::recursive);
        fs::create_directories(scratch_.path("plugins"));
        fs::copy(source_file("plugins/accel"), scratch_.path("plugins/accel"), fs::copy_options::recursive);
        environment_.set("CLARITY_KERNEL_PATH", scratch_.path("cl"));
        scene_ = shared_scene(scene_of(box(1)));
        settings_ = make_settings({{"accel", "bvh2"}, {"size", "32x24"}, {"lanes", "4"}});
    }
    // Inserts a line that is not OpenCL C after the first `after` lines of a file.
    void break_line(const std::string& name, int after) {
        std::istringstream in(scratch_.read(name));
        std::ostringstream out;
        std::string line;
        for (int i = 0; std::getline(in, line); ++i) {
            if (i == after) out << "this_is_no_type x;\n";
            out << line << '\n';
        }
        scratch_.write(name, out.str());
    }
    void expect_error_at(const std::string& where) {
        Progress progress;
        Preparer preparer(Workbench::get().plugins(), std::make_shared<Device>(choose_device("")));
        try {
            preparer.prepare(scene_, settings_, progress);
            FAIL() << "a kernel with an error was built";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), Exit::kernel_build_failed) << error.what();
            EXPECT_NE(std::string(error.what()).find(where), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find("this_is_no_type"), std::string::npos) << error.what();
            EXPECT_NE(error.details().find(where), std::string::npos) << error.details();
        }
    }

    Scratch scratch_;
    Environment environment_;
    ScenePtr scene_;
    Settings settings_;
};

TEST_F(KernelErrors, NameFileAndLineOfTheTracer) {
    break_line("cl/tracers/iterative.cl", 20);
    expect_error_at("cl/tracers/iterative.cl:21");
}

TEST_F(KernelErrors, NameFileAndLineOfAPrimitive) {
    break_line("cl/primitives/triangle.h", 7);
    expect_error_at("cl/primitives/triangle.h:8");
}

TEST_F(KernelErrors, NameFileAndLineOfAPluginsTraversal) {
    break_line("plugins/accel/bvh2/bvh2.cl", 5);
    expect_error_at("plugins/accel/bvh2/bvh2.cl:6");
}

TEST_F(KernelErrors, KeepThePreviousProgramUsable) {
    const auto device = std::make_shared<Device>(choose_device(""));
    Preparer preparer(Workbench::get().plugins(), device);
    FrameRenderer frames(device);
    Progress progress;
    const View view = view_from({0, 0, 5}, {0, 0, 0}, 45);
    const auto good = preparer.prepare(scene_, settings_, progress);
    frames.trace(*good, settings_, view, 0, false, progress);
    const ByteImage before = frames.read_display(settings_);
    const std::string sound = scratch_.read("cl/tracers/iterative.cl");
    break_line("cl/tracers/iterative.cl", 20);
    Settings other = settings_;
    other.lanes = 8;  // needs another program, so that something is compiled
    EXPECT_THROW(preparer.prepare(scene_, other, progress), Error);
    frames.trace(*good, settings_, view, 0, false, progress);
    EXPECT_EQ(frames.read_display(settings_).pixels, before.pixels);
    scratch_.write("cl/tracers/iterative.cl", sound);
    EXPECT_NO_THROW(preparer.prepare(scene_, other, progress));
}

TEST_F(KernelErrors, SetTheExitCode) {
    const char* program = std::getenv("CLARITY_WORKER");
    if (!program || !fs::exists(program)) GTEST_SKIP() << "SKIPPED: no program `clarity`; ctest names it in CLARITY_WORKER";
    break_line("cl/tracers/iterative.cl", 20);
    const std::string out = scratch_.path("a.png"), said = scratch_.path("said");
    const std::string command =
        std::string(program) + " render " + source_file("scenes/primitives.scene") + " -o " + out + " --size 32x24 2>" + said;
    const int status = std::system(command.c_str());
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), static_cast<int>(Exit::kernel_build_failed));
    EXPECT_NE(scratch_.read("said").find("cl/tracers/iterative.cl:21"), std::string::npos) << scratch_.read("said");
    EXPECT_FALSE(fs::exists(out));
}

}  // namespace
