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
    // Puts a line that is no OpenCL C before the first line of a file that begins with `before`. Returns its place, FILE:LINE.
    std::string break_line(const std::string& name, const std::string& before) {
        std::istringstream in(scratch_.read(name));
        std::ostringstream out;
        std::string line, place;
        for (int number = 1; std::getline(in, line); ++number) {
            if (place.empty() && line.compare(0, before.size(), before) == 0) {
                out << "this_is_no_type x;\n";
                place = name + ":" + std::to_string(number);
            }
            out << line << '\n';
        }
        EXPECT_NE(place, "") << name << " has no line " << before;
        scratch_.write(name, out.str());
        return place;
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
    expect_error_at(break_line("cl/tracers/iterative/iterative.cl", "RT_PICTURE_KERNEL"));
}

TEST_F(KernelErrors, NameFileAndLineOfAPrimitive) {
    expect_error_at(break_line("cl/primitives/triangle.h", "#if RT_CPU"));
}

TEST_F(KernelErrors, NameFileAndLineOfAPluginsTraversal) {
    expect_error_at(break_line("plugins/accel/bvh2/bvh2.cl", "void RT_TRAVERSE"));
}

TEST_F(KernelErrors, NameFileAndLineOfAPartOfAPlugin) {
    settings_ = make_settings({{"accel", "bvh8"}, {"size", "32x24"}, {"lanes", "4"}});
    expect_error_at(break_line("plugins/accel/bvh8/bvh8_interval_packet.cl", "RT_INLINE"));
}

TEST_F(KernelErrors, NameFileAndLineOfAHeaderThatAPluginIncludes) {
    settings_ = make_settings({{"accel", "bvh4"}, {"size", "32x24"}, {"lanes", "4"}});
    expect_error_at(break_line("cl/lanes/packet_traversal.h", "#ifndef RT_PACKET_TRAVERSAL_H"));
}

TEST_F(KernelErrors, NameFileAndLineBehindAnInclude) {
    settings_ = make_settings({{"accel", "bvh4"}, {"size", "32x24"}, {"lanes", "4"}});
    expect_error_at(break_line("plugins/accel/bvh4/bvh4.cl", "#undef RT_PACKET_STACK_SIZE"));
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
    const std::string sound = scratch_.read("cl/tracers/iterative/iterative.cl");
    break_line("cl/tracers/iterative/iterative.cl", "RT_PICTURE_KERNEL");
    Settings other = settings_;
    other.lanes = 8;  // needs another program, so that something is compiled
    EXPECT_THROW(preparer.prepare(scene_, other, progress), Error);
    frames.trace(*good, settings_, view, 0, false, progress);
    EXPECT_EQ(frames.read_display(settings_).pixels, before.pixels);
    scratch_.write("cl/tracers/iterative/iterative.cl", sound);
    EXPECT_NO_THROW(preparer.prepare(scene_, other, progress));
}

TEST_F(KernelErrors, SetTheExitCode) {
    const char* program = std::getenv("CLARITY_WORKER");
    if (!program || !fs::exists(program)) GTEST_SKIP() << "SKIPPED: no program `clarity`; ctest names it in CLARITY_WORKER";
    const std::string place = break_line("cl/tracers/iterative/iterative.cl", "RT_PICTURE_KERNEL");
    const std::string out = scratch_.path("a.png"), said = scratch_.path("said");
    const std::string command =
        std::string(program) + " render " + source_file("scenes/primitives.scene") + " -o " + out + " --size 32x24 2>" + said;
    const int status = std::system(command.c_str());
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), static_cast<int>(Exit::kernel_build_failed));
    EXPECT_NE(scratch_.read("said").find(place), std::string::npos) << scratch_.read("said");
    EXPECT_FALSE(fs::exists(out));
}

}  // namespace
