// render_test.cpp -- `clarity render` from outside: files, statistics, interruption, and the texts on stdout and stderr.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/run_program.hpp"
#include "support/clock.hpp"
#include "support/scratch.hpp"

namespace fs = std::filesystem;

namespace {

class Render : public ::testing::Test {
 protected:
    void SetUp() override {
        if (run_program({"devices"}).exit_code == 3) GTEST_SKIP() << "no OpenCL device on this machine";
        scene_ = scratch_.write("a.scene",
                                "camera main eye 0 1 6 target 0 1 0 fov 40\n"
                                "light point position 3 6 4\n"
                                "background .2 .3 .5\n"
                                "material mirror color .2 .2 .2 reflect .8\n"
                                "plane normal 0 1 0 offset 0\n"
                                "sphere center 0 1 0 radius 1 material mirror\n");
        fs::create_directory(scratch_.path("out"));
    }
    std::string out(const std::string& name) const { return scratch_.path("out/" + name); }
    std::vector<std::string> words(const std::vector<std::string>& more) const {
        std::vector<std::string> all = {"render", scene_, "--size", "64x48"};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
    std::vector<std::string> files() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(scratch_.path("out")))
            names.push_back(entry.path().filename().string());
        std::sort(names.begin(), names.end());
        return names;
    }

    Scratch scratch_;
    std::string scene_;
};

}  // namespace

TEST_F(Render, WritesOnePictureAndItsStatistics) {
    const ProgramResult result =
        run_program(words({"-o", out("a.png"), "--stats", out("a.json"), "--depth", "3", "--repeat", "3"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, "") << "stdout is for data that was asked for";
    EXPECT_EQ(result.err.find('\033'), std::string::npos) << "no terminal, no colour and no bar: " << result.err;
    EXPECT_EQ(files(), (std::vector<std::string>{"a.json", "a.png"}));
    const std::string png = scratch_.read("out/a.png");
    EXPECT_EQ(png.substr(1, 3), "PNG");
    const nlohmann::json stats = nlohmann::json::parse(scratch_.read("out/a.json"));
    for (const char* key :
         {"device", "accel", "tracer", "depth", "packet", "lanes", "size", "frame_ms", "build_ms", "compile_ms", "import_ms",
          "rays", "mrays_per_s", "dropped_rays", "nodes", "accel_bytes", "triangles"})
        EXPECT_TRUE(stats.contains(key)) << key;
    EXPECT_EQ(stats["accel"], "bvh8");
    EXPECT_EQ(stats["depth"], 3);
    EXPECT_EQ(stats["size"], "64x48");
    EXPECT_EQ(stats["frames_timed"], 3);
    EXPECT_LE(stats["frame_ms"]["min"], stats["frame_ms"]["median"]);
    EXPECT_LE(stats["frame_ms"]["median"], stats["frame_ms"]["max"]);
    EXPECT_GT(stats["frame_ms"]["min"].get<double>(), 0);
    EXPECT_EQ(stats["rays"]["primary"], 64 * 48) << "rays of one frame, independent of --repeat";
    EXPECT_GT(stats["rays"]["shadow"].get<int>(), 0);
    EXPECT_GT(stats["rays"]["secondary"].get<int>(), 0) << "the mirror reflects rays";
    EXPECT_GT(stats["mrays_per_s"].get<double>(), 0);
    EXPECT_EQ(stats["triangles"], 0);
}

TEST_F(Render, StatisticsOnStdoutAreNothingButJson) {
    const ProgramResult result =
        run_program(words({"-o", out("a.png"), "--stats", "-", "--depth", "1", "--set", "shadows=false"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const nlohmann::json stats = nlohmann::json::parse(result.out);
    EXPECT_EQ(stats["rays"], nlohmann::json({{"primary", 64 * 48}, {"shadow", 0}, {"secondary", 0}}));
}

TEST_F(Render, AnOptionWinsOverSet) {
    const ProgramResult result = run_program(words({"-o", out("a.png"), "--stats", "-", "--depth", "2", "--set", "depth=4"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(nlohmann::json::parse(result.out)["depth"], 2);
}

TEST_F(Render, FloatFormatsHoldTheFirstHit) {
    const ProgramResult result = run_program(words({"-o", out("t.pfm"), "--aov", "t"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const std::string pfm = scratch_.read("out/t.pfm"), head = "Pf\n64 48\n-1.0\n";
    ASSERT_EQ(pfm.substr(0, head.size()), head);
    ASSERT_EQ(pfm.size(), head.size() + 64 * 48 * sizeof(float));
    // The centre ray hits the sphere's front at distance 5, and a little more because it is half a pixel off the axis.
    float t = 0;
    std::memcpy(&t, pfm.data() + head.size() + (24 * 64 + 32) * sizeof(float), sizeof t);
    EXPECT_NEAR(t, 5, 0.01);
    const ProgramResult color = run_program(words({"-o", out("c.pfm")}));
    ASSERT_EQ(color.exit_code, 0) << color.err;
    EXPECT_EQ(scratch_.read("out/c.pfm").substr(0, 3), "PF\n");
    const ProgramResult exr = run_program(words({"-o", out("c.exr")}));
    if (exr.exit_code == 0)
        EXPECT_EQ(scratch_.read("out/c.exr").substr(0, 4), "\x76\x2f\x31\x01");
    else
        EXPECT_NE(exr.err.find("libopenexr-dev"), std::string::npos) << "only a build without OpenEXR may refuse: " << exr.err;
}

TEST_F(Render, FramesAreNumbered) {
    const ProgramResult result = run_program(words({"-o", out("f_###.png"), "--frames", "8-12/2", "--time", "1.5"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(files(),
              (std::vector<std::string>{"f_008.json", "f_008.png", "f_010.json", "f_010.png", "f_012.json", "f_012.png"}))
        << "each picture, and its record";
    EXPECT_EQ(scratch_.read("out/f_008.png"), scratch_.read("out/f_012.png")) << "this scene does not move";
    EXPECT_NE(result.err.find("--time 1.5: the scene does not move"), std::string::npos) << result.err;
}

// Frame n is at n / fps on the clip's clock, and looks as --time shows it.
TEST_F(Render, FramesOfAMovingScene) {
    scratch_.write("cube.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    scene_ = scratch_.write("moving.scene",
                            "camera main eye 0 0 9\nload cube.obj name car\nanimate car translate 0 0 0 0  2 1 0 0\n");
    ASSERT_EQ(run_program(words({"-o", out("f_#.pfm"), "--frames", "0-4/2", "--fps", "2"})).exit_code, 0);
    ASSERT_EQ(run_program(words({"-o", out("rest.pfm")})).exit_code, 0);
    ASSERT_EQ(run_program(words({"-o", out("one.pfm"), "--time", "1", "--clip", "animate"})).exit_code, 0);
    EXPECT_EQ(scratch_.read("out/f_0.pfm"), scratch_.read("out/rest.pfm"));
    EXPECT_EQ(scratch_.read("out/f_2.pfm"), scratch_.read("out/one.pfm"));
    EXPECT_NE(scratch_.read("out/f_4.pfm"), scratch_.read("out/one.pfm"));
    const ProgramResult info = run_program({"info", scene_, "--json", "--time", "2"});
    ASSERT_EQ(info.exit_code, 0) << info.err;
    const nlohmann::json json = nlohmann::json::parse(info.out);
    EXPECT_NEAR(json["bounds"]["max"][0].get<double>(), 2, 1e-6);
    EXPECT_EQ(json["animations"][0]["name"], "animate");
    EXPECT_EQ(json["animations"][0]["end_s"], 2);
    const ProgramResult unknown = run_program(words({"-o", out("x.pfm"), "--clip", "walk"}));
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_NE(unknown.err.find("animate"), std::string::npos) << unknown.err;
}

// Clips have numbers, counted from 0; a name counts first.
TEST_F(Render, ClipsByNumber) {
    scratch_.write("cube.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    scene_ = scratch_.write("moving.scene",
                            "camera main eye 0 0 9\nload cube.obj name car\nanimate car translate 0 0 0 0  2 1 0 0\n");
    ASSERT_EQ(run_program(words({"-o", out("name.pfm"), "--time", "1", "--clip", "animate"})).exit_code, 0);
    ASSERT_EQ(run_program(words({"-o", out("number.pfm"), "--time", "1", "--clip", "0"})).exit_code, 0);
    EXPECT_EQ(scratch_.read("out/name.pfm"), scratch_.read("out/number.pfm"));
    const ProgramResult unknown = run_program(words({"-o", out("x.pfm"), "--time", "1", "--clip", "1"}));
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_NE(unknown.err.find("0 animate"), std::string::npos) << unknown.err;
}

// A warning of the importer, and one of --time: each is printed once.
TEST_F(Render, AWarningIsPrintedOnce) {
    const auto count = [](const std::string& text, const std::string& part) {
        size_t found = 0;
        for (size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++found;
        return found;
    };
    scratch_.write("cube.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    scene_ =
        scratch_.write("moving.scene", "load cube.obj\ntriangle vertices 0 0 0 0 0 0 0 0 0\nsphere center 0 1 0 radius 1\n");
    const ProgramResult result = run_program(words({"-o", out("a.png"), "--time", "1.5"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(count(result.err, "a triangle without area"), 1u) << result.err;
    EXPECT_EQ(count(result.err, "warning: --time 1.5: the scene does not move"), 1u) << result.err;
    const ProgramResult info = run_program({"info", scene_});
    EXPECT_EQ(count(info.out + info.err, "a triangle without area"), 1u) << info.out << info.err;
    EXPECT_EQ(run_program(words({"-o", out("a.png")})).err.find("--time"), std::string::npos);
}

TEST_F(Render, CameraAndLightChangeThePicture) {
    ASSERT_EQ(run_program(words({"-o", out("a.pfm")})).exit_code, 0);
    ASSERT_EQ(run_program(words({"-o", out("b.pfm"), "--camera", "-3,2,5,0,1,0,50"})).exit_code, 0);
    ASSERT_EQ(run_program(words({"-o", out("c.pfm"), "--light", "-3,6,4"})).exit_code, 0);
    ASSERT_EQ(run_program(words({"-o", out("d.pfm"), "--camera", "main"})).exit_code, 0);
    EXPECT_NE(scratch_.read("out/a.pfm"), scratch_.read("out/b.pfm"));
    EXPECT_NE(scratch_.read("out/a.pfm"), scratch_.read("out/c.pfm"));
    EXPECT_EQ(scratch_.read("out/a.pfm"), scratch_.read("out/d.pfm"));
}

TEST_F(Render, QuietPrintsNothingVerbosePrintsMore) {
    EXPECT_EQ(run_program(words({"-o", out("a.png"), "-q"})).err, "");
    const std::string normal = run_program(words({"-o", out("a.png")})).err;
    EXPECT_NE(normal.find(out("a.png")), std::string::npos) << normal;
    EXPECT_GT(run_program(words({"-o", out("a.png"), "-v"})).err.size(), normal.size());
    ASSERT_EQ(run_program(words({"-o", out("a.png"), "-q", "--log-file", out("log.txt")})).exit_code, 0);
    EXPECT_NE(scratch_.read("out/log.txt").find("a.png"), std::string::npos) << "the log file has every message";
}

// The clock of a device is another than the host's: a frame has launches within its own time.
TEST_F(Render, ATimelineHasWhatTheProgramAndItsDeviceDid) {
    ASSERT_EQ(run_program(words({"-o", out("a.png")})).exit_code, 0);
    ASSERT_EQ(run_program(words({"-o", out("b.png"), "--trace", out("b.json"), "--spp", "4"})).exit_code, 0);
    const nlohmann::json file = nlohmann::json::parse(scratch_.read("out/b.json"));
    std::map<std::string, double> first, last;  // by kind, in us
    std::map<int, std::string> tracks;
    std::set<int> of_launches;
    std::vector<std::pair<double, double>> launches, frames;
    for (const nlohmann::json& event : file["traceEvents"]) {
        if (event["name"] == "thread_name") tracks[event["tid"]] = event["args"]["name"];
        if (event["ph"] != "X") continue;
        const double begin = event["ts"], end = begin + event["dur"].get<double>();
        EXPECT_GE(begin, 0) << event;
        EXPECT_GE(end, begin) << event;
        const std::string kind = event["cat"];
        first[kind] = first.count(kind) ? std::min(first[kind], begin) : begin;
        last[kind] = std::max(last[kind], end);
        if (kind == "launch") of_launches.insert(event["tid"].get<int>()), launches.emplace_back(begin, end);
        if (kind == "frame") frames.emplace_back(begin, end);
    }
    for (const char* kind : {"load", "import", "build", "compile", "worker", "frame", "launch", "copy", "write"})
        EXPECT_TRUE(first.count(kind)) << kind << " has no span";
    ASSERT_FALSE(of_launches.empty());
    EXPECT_NE(tracks[*of_launches.begin()].find("queue"), std::string::npos) << tracks[*of_launches.begin()];
    EXPECT_LE(last["import"], first["build"]);
    EXPECT_LE(last["launch"], first["write"] + 100);
    for (const auto& [begin, end] : frames)
        EXPECT_TRUE(std::any_of(launches.begin(), launches.end(), [begin = begin - 100, end = end + 100](const auto& launch) {
            return launch.first > begin && launch.second < end;
        })) << begin;
    ASSERT_EQ(run_program(words({"-o", out("c.png"), "--spp", "4"})).exit_code, 0);
    EXPECT_EQ(scratch_.read("out/b.png"), scratch_.read("out/c.png")) << "recording changes the picture";
}

// What failed is what one wants to see.
TEST_F(Render, ATimelineIsWrittenOfWhatFails) {
    const std::string broken = scratch_.write("broken.scene", "sphere colour\n");
    EXPECT_NE(run_program({"info", broken, "--trace", out("a.json")}).exit_code, 0);
    EXPECT_NE(scratch_.read("out/a.json").find("import " + broken), std::string::npos);
}

TEST_F(Render, CtrlCWritesWhatIsAccumulated) {
    RunOptions options;
    options.signal = SIGINT;
    options.signal_when = "rendering";
    const ProgramResult result = run_program(words({"-o", out("a.png"), "--spp", "65536", "-v"}), options);
    EXPECT_EQ(result.exit_code, 130) << result.err;
    EXPECT_LT(result.seconds_after_signal, clarity::test::at_most(5));
    EXPECT_NE(result.err.find("interrupted"), std::string::npos) << result.err;
    // With or without a complete sample, there is a whole picture or none, but no partial file.
    const bool any = result.err.find("no sample was complete") == std::string::npos;
    EXPECT_EQ(files(), any ? std::vector<std::string>{"a.png"} : std::vector<std::string>{});
    if (any) {
        EXPECT_EQ(scratch_.read("out/a.png").substr(1, 3), "PNG");
        EXPECT_NE(result.err.find("of 65536 samples"), std::string::npos) << result.err;
    }
}

TEST_F(Render, CtrlCLaterKeepsTheSamplesSoFar) {
    RunOptions options;
    options.signal = SIGTERM;
    // The bar of a terminal says how many samples there are.
    options.signal_when = "rendering a.png [........................]   1 % ";
    options.terminal = true;
    options.environment = {{"TERM", "xterm"}, {"NO_COLOR", "1"}};
    const ProgramResult result = run_program(words({"-o", out("a.png"), "--spp", "65536"}), options);
    EXPECT_EQ(result.exit_code, 130) << result.err;
    EXPECT_LT(result.seconds_after_signal, clarity::test::at_most(5));
    EXPECT_EQ(files(), std::vector<std::string>{"a.png"});
    EXPECT_NE(result.err.find("of 65536 samples"), std::string::npos) << result.err;
}

TEST_F(Render, ATerminalHasAProgressBarAndNoColorDisablesColours) {
    RunOptions options;
    options.terminal = true;
    options.environment = {{"TERM", "xterm"}, {"NO_COLOR", ""}};
    const std::vector<std::string> slow = words({"-o", out("a.png"), "--spp", "4000"});
    const ProgramResult colored = run_program(slow, options);
    ASSERT_EQ(colored.exit_code, 0) << colored.err;
    EXPECT_NE(colored.err.find("\r\033[K"), std::string::npos);
    EXPECT_NE(colored.err.find(" %"), std::string::npos) << colored.err;
    EXPECT_NE(colored.err.find("\033[36m"), std::string::npos) << colored.err;
    options.environment["NO_COLOR"] = "1";
    const ProgramResult plain = run_program(slow, options);
    ASSERT_EQ(plain.exit_code, 0) << plain.err;
    EXPECT_NE(plain.err.find(" %"), std::string::npos) << plain.err;
    EXPECT_EQ(plain.err.find("\033[3"), std::string::npos) << plain.err;
}

TEST_F(Render, ABrokenKernelExits5WithTheCompilersMessage) {
    // A developer's copy of the kernels with an error in it.
    fs::copy(fs::path(CLARITY_SOURCE_DIR) / "cl", scratch_.path("cl"), fs::copy_options::recursive);
    scratch_.write("cl/shading/surface.h", "this is no OpenCL C;\n");
    RunOptions options;
    options.environment = {{"CLARITY_KERNEL_PATH", scratch_.path("cl")}};
    const ProgramResult result = run_program(words({"-o", out("a.png")}), options);
    EXPECT_EQ(result.exit_code, 5) << result.err;
    EXPECT_NE(result.err.find("error"), std::string::npos) << result.err;
    EXPECT_TRUE(files().empty());
}
