// frames_test.cpp -- frames of an animation that several processes render, and some of them are killed.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include "base/machine.hpp"
#include "cli/run_program.hpp"
#include "support/scratch.hpp"
#include "view/settings/settings.hpp"

namespace fs = std::filesystem;

namespace {

class Frames : public ::testing::Test {
 protected:
    void SetUp() override {
        if (run_program({"devices"}).exit_code == 3) GTEST_SKIP() << "no OpenCL device on this machine";
        scratch_.write("cube.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        set_scene("");
        fs::create_directory(scratch_.path("out"));
    }
    void set_scene(const std::string& more) {
        scratch_.write("moving.scene",
                       "camera main eye 0 0 9\nload cube.obj name car\nanimate car translate 0 0 0 0  2 1 0 0\n" + more);
    }

    std::string out(const std::string& name) const { return scratch_.path("out/" + name); }
    std::vector<std::string> files() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(scratch_.path("out")))
            names.push_back(entry.path().filename().string());
        std::sort(names.begin(), names.end());
        return names;
    }
    std::vector<std::string> words(const std::string& output, const std::vector<std::string>& more) const {
        std::vector<std::string> all = {"render", scratch_.path("moving.scene"), "-o", out(output), "--size", "64x48", "--fps",
                                        "3"};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
    ProgramResult render(const std::string& output, const std::vector<std::string>& more) const {
        return run_program(words(output, more));
    }
    nlohmann::json record(const std::string& name) const { return nlohmann::json::parse(scratch_.read("out/" + name)); }

    Scratch scratch_;
};

}  // namespace

TEST_F(Frames, EachHasARecord) {
    ASSERT_EQ(render("f_##.png", {"--frames", "2-6/2"}).exit_code, 0);
    EXPECT_EQ(files(), (std::vector<std::string>{"f_02.json", "f_02.png", "f_04.json", "f_04.png", "f_06.json", "f_06.png"}));
    const nlohmann::json four = record("f_04.json");
    EXPECT_EQ(four["frame"], 4);
    EXPECT_EQ(four["picture"], "f_04.png");
    EXPECT_EQ(four["digest"].get<std::string>().size(), 32u);
    EXPECT_NE(four["digest"], record("f_02.json")["digest"]) << "the scene moves";
    EXPECT_NE(four["pixels"], record("f_02.json")["pixels"]);
    EXPECT_GT(four["seconds"].get<double>(), 0);
    EXPECT_EQ(four["host"], clarity::host_name());
    EXPECT_NE(four["device"], "");
    EXPECT_EQ(four["options"]["settings"][0], (nlohmann::json{"size", "64x48"}));
    EXPECT_NE(scratch_.read("out/f_04.png").find(four["digest"].get<std::string>()), std::string::npos)
        << "in the picture, too";
}

// What makes the same picture has the same digest; everything else has another.
TEST_F(Frames, TheDigestIsThatOfThePicture) {
    const auto digest = [&](const std::vector<std::string>& more) {
        std::vector<std::string> all = {"--frames", "3"};
        all.insert(all.end(), more.begin(), more.end());
        EXPECT_EQ(render("d_#.png", all).exit_code, 0);
        return record("d_3.json")["digest"].get<std::string>();
    };
    const std::string plain = digest({});
    EXPECT_EQ(digest({"--accel", "bvh2", "--lanes", "4", "--packet", "8x8", "--device", "cpu"}), plain);
    EXPECT_EQ(digest({"--portable", "true", "--debug", "true", "--poses", "build", "--trial", "off"}), plain);
    // Tracers that say that they make the same picture; what a tracer costs is of the tracer.
    for (const clarity::TracerChoice& choice : clarity::tracer_choices())
        EXPECT_EQ(digest({"--tracer", choice.id}) == plain, choice.picture == clarity::picture_of_tracer("auto")) << choice.id;
    EXPECT_NE(digest({"--tracer", "wavefront", "--aov", "generations"}),
              digest({"--tracer", "iterative", "--aov", "generations"}));
    EXPECT_NE(digest({"--spp", "2"}), plain);
    EXPECT_NE(digest({"--exposure", "2"}), plain);
    EXPECT_NE(digest({"--camera", "0,1,9,0,0,0"}), plain);
    EXPECT_NE(digest({"--fps", "4"}), plain);
    set_scene("light point position 3 6 4\n");
    EXPECT_NE(digest({}), plain);
}

// While the shutter is open, files 4 to 12 of a sequence are seen.
TEST_F(Frames, DigestHoldsEveryFileThatASampleShows) {
    const auto write = [&](int number, float x) {
        scratch_.write("walk_" + std::to_string(number) + ".obj",
                       "v " + std::to_string(x) + " 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    };
    for (int number = 1; number <= 16; ++number) write(number, float(number) / 16);
    scratch_.write("moving.scene", "camera main eye 0 0 9\nload \"walk_#.obj\"\n");
    const auto digest = [&] {
        EXPECT_EQ(render("s_#.pfm", {"--frames", "1", "--shutter", "1", "--spp", "8"}).exit_code, 0);
        return record("s_1.json")["digest"].get<std::string>();
    };
    const std::string plain = digest();
    write(15, 0);
    EXPECT_EQ(digest(), plain) << "the picture does not show this file";
    for (const int number : {4, 6, 10, 12}) {
        write(number, -1);
        EXPECT_NE(digest(), plain) << number;
        write(number, float(number) / 16);
    }
    EXPECT_EQ(digest(), plain);
}

TEST_F(Frames, AShareIsEveryNth) {
    ASSERT_EQ(render("a_##.png", {"--frames", "1-9/2"}).exit_code, 0);
    ASSERT_EQ(render("b_##.png", {"--frames", "1-9/2", "--frames-of", "2/3"}).exit_code, 0);
    std::vector<std::string> pictures;
    for (const std::string& name : files())
        if (name[0] == 'b' && name.find(".png") != std::string::npos) pictures.push_back(name);
    EXPECT_EQ(pictures, (std::vector<std::string>{"b_03.png", "b_09.png"}));
    EXPECT_EQ(scratch_.read("out/b_03.png"), scratch_.read("out/a_03.png")) << "whoever renders a frame";
    EXPECT_EQ(scratch_.read("out/b_09.png"), scratch_.read("out/a_09.png"));
    const ProgramResult none = render("c_##.png", {"--frames", "1-2", "--frames-of", "3/3"});
    EXPECT_EQ(none.exit_code, 0) << none.err;
    EXPECT_NE(none.err.find("this share is empty"), std::string::npos) << none.err;
    for (const char* wrong : {"0/3", "4/3", "3", "1/0", "a/b", "1/2/3", "-1/2"}) {
        const ProgramResult result = render("c_##.png", {"--frames", "1-2", std::string("--frames-of=") + wrong});
        EXPECT_EQ(result.exit_code, 2) << wrong;
        EXPECT_NE(result.err.find(wrong), std::string::npos) << result.err;
    }
    EXPECT_EQ(render("c.png", {"--frames-of", "1/2"}).exit_code, 2) << "a share of nothing";
}

// --skip-existing trusts neither a name, nor a record of another scene, nor a file that is not the one that was recorded.
TEST_F(Frames, OnlyWholeFramesOfTheSameSceneAreSkipped) {
    const std::vector<std::string> all = {"--frames", "1-3", "--skip-existing"};
    ASSERT_EQ(render("f_#.png", {"--frames", "1-3"}).exit_code, 0);
    const std::string one = scratch_.read("out/f_1.png"), two = scratch_.read("out/f_2.png"),
                      three = scratch_.read("out/f_3.png");
    ProgramResult result = render("f_#.png", all);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.err.find("3 of 3 pictures"), std::string::npos) << result.err;
    scratch_.write("out/f_1.png", one.substr(0, one.size() / 2));
    fs::remove(out("f_2.json"));
    scratch_.write("out/f_3.json", "{");
    result = render("f_#.png", all);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err.find("there already"), std::string::npos) << result.err;
    EXPECT_EQ(scratch_.read("out/f_1.png"), one);
    EXPECT_EQ(scratch_.read("out/f_2.png"), two);
    EXPECT_EQ(scratch_.read("out/f_3.png"), three);
    fs::remove(out("f_2.png"));
    result = render("f_#.png", all);
    EXPECT_NE(result.err.find("2 of 3 pictures"), std::string::npos) << result.err;
    set_scene("background 1 0 0\n");
    result = render("f_#.png", all);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err.find("there already"), std::string::npos) << result.err;
    EXPECT_NE(scratch_.read("out/f_1.png"), one);
    EXPECT_EQ(files(), (std::vector<std::string>{"f_1.json", "f_1.png", "f_2.json", "f_2.png", "f_3.json", "f_3.png"}))
        << "no claim is left";
    EXPECT_EQ(render("f_#.png", {"--skip-existing", "--watch"}).exit_code, 2);
    EXPECT_EQ(render("f_#.png", {"--frames", "1-3", "--stats", out("f_2.json")}).exit_code, 2) << "the record of a frame";
}

TEST_F(Frames, AnInterruptedFrameHasNoFile) {
    RunOptions options;
    options.signal = SIGTERM;
    options.signal_when = "rendering";
    const ProgramResult result =
        run_program(words("f_#.png", {"--frames", "1-2", "--spp", "65536", "--size", "800x600", "-v"}), options);
    EXPECT_EQ(result.exit_code, 130) << result.err;
    EXPECT_NE(result.err.find("nothing is written"), std::string::npos) << result.err;
    EXPECT_EQ(files(), std::vector<std::string>{});
}

TEST_F(Frames, VerifyRendersAgain) {
    ASSERT_EQ(render("f_#.png", {"--frames", "1-2"}).exit_code, 0);
    const auto verify = [&] { return run_program({"render", "--verify", out("f_1.json"), out("f_2.json"), "-q"}); };
    ProgramResult result = verify();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, out("f_1.json") + ": the same, bit for bit\n" + out("f_2.json") + ": the same, bit for bit\n");
    const std::string whole = scratch_.read("out/f_2.png");
    scratch_.write("out/f_2.png", whole + "x");
    result = verify();
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.out.find("f_2.png is not the file that was recorded"), std::string::npos) << result.out;
    scratch_.write("out/f_2.png", whole);
    // A record that tells of other pixels than rendering gives, as after a fault of a device.
    nlohmann::json wrong = record("f_2.json");
    wrong["pixels"] = std::string(32, '0');
    scratch_.write("out/f_2.json", wrong.dump());
    result = verify();
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.out.find("is another than"), std::string::npos) << result.out;
    set_scene("background 1 0 0\n");
    result = verify();
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.out.find("have changed"), std::string::npos) << result.out;
    EXPECT_EQ(run_program({"render", "--verify", scratch_.path("moving.scene")}).exit_code, 1) << "no record";
}

// --aov all: one file with the layers that files of their own would have.
TEST_F(Frames, LayersOfOneFile) {
    const ProgramResult png = render("a.png", {"--aov", "all"});
    EXPECT_EQ(png.exit_code, 2);
    EXPECT_NE(png.err.find(".exr"), std::string::npos) << png.err;
    const ProgramResult result = render("a_#.exr", {"--aov", "all", "--frames", "3"});
    if (result.err.find("libopenexr-dev") != std::string::npos) GTEST_SKIP() << "a build without EXR";
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const std::string exr = scratch_.read("out/a_3.exr").substr(0, 4000);
    for (const char* channel : {"B", "G", "R", "instance.Y", "normal.X", "normal.Y", "normal.Z", "prim.Y", "t.Y", "uv.X"})
        EXPECT_NE(exr.find(channel + std::string("\0\2\0\0\0", 5)), std::string::npos) << channel << ", 32-bit floats";
    EXPECT_NE(record("a_3.json")["command"].get<std::string>().find("--aov all"), std::string::npos);
    EXPECT_EQ(run_program({"render", "--verify", out("a_3.json"), "-q"}).out, out("a_3.json") + ": the same, bit for bit\n");
    ASSERT_EQ(render("c_#.exr", {"--frames", "3"}).exit_code, 0);
    EXPECT_NE(record("c_3.json")["digest"], record("a_3.json")["digest"]);
}

// A claim of a process that is gone, or that nobody renews, holds nobody up; a living one does, and then its frame is left out.
TEST_F(Frames, ClaimsExpire) {
    const std::vector<std::string> all = {"--frames", "1-2", "--skip-existing"};
    scratch_.write("out/.f_1.png.claim", clarity::host_name() + " 999999999\n");
    const std::string old = scratch_.write("out/.f_2.png.claim", "another-host 1\n");
    fs::last_write_time(old, fs::file_time_type::clock::now() - std::chrono::seconds(90));
    ProgramResult result = render("f_#.png", all);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(files(), (std::vector<std::string>{"f_1.json", "f_1.png", "f_2.json", "f_2.png"}));
    // Of a process that was killed just before its end.
    scratch_.write("out/.f_1.png.claim", clarity::host_name() + " 999999999\n");
    EXPECT_EQ(render("f_#.png", all).exit_code, 0);
    EXPECT_EQ(files().size(), 4u) << "the claim of a complete frame is left";
    fs::remove(out("f_2.png"));
    scratch_.write("out/.f_2.png.claim", "another-host 1\n");
    RunOptions options;
    options.signal = SIGTERM;
    options.signal_when = "waiting for them";
    result = run_program(words("f_#.png", all), options);
    EXPECT_EQ(result.exit_code, 130) << result.err;
    EXPECT_FALSE(fs::exists(out("f_2.png"))) << "another process renders it";
}

// Four processes with the same frames: each frame is rendered once, and each process ends when all are there.
TEST_F(Frames, SeveralProcessesShareOneRange) {
    ASSERT_EQ(render("serial_##.png", {"--frames", "1-12", "--spp", "1024"}).exit_code, 0);
    std::vector<ProgramResult> results(4);
    std::vector<std::thread> threads;
    for (ProgramResult& result : results)
        threads.emplace_back([&] { result = render("f_##.png", {"--frames", "1-12", "--spp", "1024", "--skip-existing"}); });
    for (std::thread& thread : threads) thread.join();
    size_t written = 0;
    for (const ProgramResult& result : results) {
        EXPECT_EQ(result.exit_code, 0) << result.err;
        for (size_t at = result.err.find(" Mrays/s"); at != std::string::npos; at = result.err.find(" Mrays/s", at + 1))
            ++written;
    }
    EXPECT_EQ(written, 12u) << "no work was done twice";
    for (int frame = 1; frame <= 12; ++frame) {
        char name[32];
        std::snprintf(name, sizeof name, "_%02d.png", frame);
        EXPECT_EQ(scratch_.read(std::string("out/f") + name), scratch_.read(std::string("out/serial") + name)) << name;
    }
    for (const std::string& name : files()) EXPECT_NE(name[0], '.') << name;
}

// At any moment of its life: what has a final name is whole, and the next process completes the rest.
TEST_F(Frames, ProcessesThatAreKilledLeaveCompleteFrames) {
    const std::vector<std::string> all = {"--frames", "1-24", "--spp", "2048", "--skip-existing"};
    ASSERT_EQ(render("serial_##.png", {"--frames", "1-24", "--spp", "2048"}).exit_code, 0);
    const auto check = [&](bool complete) {
        for (int frame = 1; frame <= 24; ++frame) {
            char name[32];
            std::snprintf(name, sizeof name, "_%02d.png", frame);
            const std::string found = scratch_.read(std::string("out/f") + name);
            if (complete || !found.empty()) {
                ASSERT_EQ(found, scratch_.read(std::string("out/serial") + name)) << name;
            }
        }
    };
    RunOptions options;
    options.signal = SIGKILL;
    int killed = 0;
    for (int kill = 0; kill < 12; ++kill) {
        // Every other time at some moment, else once two more frames are there.
        options.signal_after_s = kill % 2 == 0 ? 0.4 + 0.11 * (kill % 6) : -1;
        options.signal_when_made = kill % 2 == 0 ? std::string()
                                                 : out(kill < 9 ? "f_0" + std::to_string(kill + 1) + ".png"
                                                                : "f_" + std::to_string(kill + 1) + ".png");
        killed += run_program(words("f_##.png", all), options).exit_code == 128 + SIGKILL;
        check(false);
    }
    EXPECT_GE(killed, 3) << "frames are too quick for this test";
    ASSERT_EQ(run_program(words("f_##.png", all)).exit_code, 0);
    check(true);
    for (const std::string& name : files()) EXPECT_NE(name[0], '.') << name << " is left over";
}
