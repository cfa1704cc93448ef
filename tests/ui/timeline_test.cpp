// The timeline: playing, steps, scrubbing, and what the picture then shows.
#include <gtest/gtest.h>

#include <algorithm>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

// A box that turns and moves, a lamp that passes by, and a camera that follows: each frame looks different.
const char* const kTimelineScene =
    "camera main eye 0 2 7 target 0 0.5 0 fov 40\n"
    "camera chase eye 0 2 6 target 0 0 0 fov 40\n"
    "light point position -3 5 4 color .8 .7 .6 name lamp\n"
    "light directional direction 1 -2 -1 color .4 .4 .5\n"
    "background .2 .3 .5\n"
    "material floor color .7 .7 .6\n"
    "polygon material floor vertices -5 0 -5  -5 0 5  5 0 5  5 0 -5\n"
    "sphere center -1.5 .5 -1 radius .5\n"
    "load box.obj name box\n"
    "animate box translate 0 -1 .2 0  1 1 .8 .5  2 -1 .2 0\n"
    "animate box rotate 0 0 1 0 0  2 0 1 0 360\n"
    "animate lamp translate 0 -3 5 4  2 3 5 4\n"
    "animate chase translate 0 0 2 6  2 2 3 5\n";

class Timeline : public WindowTest {
 protected:
    void SetUp() override {
        WindowTest::SetUp();
        std::ofstream(folder.path() + "/box.obj") << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                                                     "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n";
        scene = folder.path() + "/moving.scene";
        std::ofstream(scene) << kTimelineScene;
    }
    std::unique_ptr<WindowDriver> open_moving(const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments = {"--size", "96x72", "--spp", "1", scene};
        arguments.insert(arguments.end(), more.begin(), more.end());
        auto window = std::make_unique<WindowDriver>(arguments);
        window->settle();
        return window;
    }
    static nlohmann::json timeline(WindowDriver& window) { return window.query("timeline"); }
    Pixels render(const std::string& options) const {
        const std::string path = folder.path() + "/rendered.png";
        const std::string line = "'" + program_path() + "' render -q --size 96x72 '" + scene + "' -o '" + path + "' " + options;
        EXPECT_EQ(std::system(line.c_str()), 0) << line;
        return read_png(path);
    }
    // The picture equals the one of the command line that the window gives.
    void expect_as_command(WindowDriver& window) const {
        const std::string path = folder.path() + "/command.png", line = command_line(window, path);
        ASSERT_EQ(run_command_line(line), 0) << line;
        EXPECT_EQ(difference(window.picture(), read_png(path), 0), 0) << line;
    }
    TemporaryFolder folder;
    std::string scene;
};

TEST_F(Timeline, ShowsWhatRenderShowsAtThatTime) {
    const auto window = open_moving();
    auto now = timeline(*window);
    EXPECT_EQ(now["clips"], nlohmann::json({"animate"}));
    EXPECT_TRUE(now["time_s"].is_null());
    const Pixels rest = window->picture();

    // A press on the track shows the frame there.
    window->click_on("track", 0.7);
    window->settle();
    now = timeline(*window);
    const double time = now["time_s"];
    EXPECT_NEAR(time, 1.4, 0.05);
    EXPECT_NEAR(time * 24, std::round(time * 24), 1e-9);
    EXPECT_EQ(now["shown_s"], time);
    const Pixels scrubbed = window->picture();
    const std::string frame = std::to_string(std::lround(time * 24));
    EXPECT_EQ(difference(scrubbed, render("--frames " + frame), 0), 0) << "frame " << frame;
    EXPECT_GT(difference(scrubbed, rest), 0.01);
    expect_as_command(*window);
    EXPECT_EQ(window->state()["undo"], "") << "a moved lamp of the file is no step";

    // The user's own camera stays, and a lamp that he has moved.
    ASSERT_EQ(window->command("edit camera 1,3,6,0,0,0,50,0,1,0"), "");
    ASSERT_EQ(window->command("edit light.0 point,0,4,5,1,0,0"), "");
    ASSERT_EQ(window->command("time 0.25"), "");
    window->settle();
    EXPECT_EQ(window->state()["eye"], nlohmann::json({1, 3, 6}));
    EXPECT_EQ(window->state()["light"], nlohmann::json({0, 4, 5}));
    expect_as_command(*window);
    window->key("ctrl+z");  // the lamp follows the file again
    window->settle();
    const float x = window->state()["light"][0];
    EXPECT_NEAR(x, -3 + 6 * 0.125, 1e-5);
    EXPECT_EQ(window->state()["message"], "");

    // A camera of the file carries along who looks through it.
    window->key("Home");
    window->key("n");
    window->key("n");
    ASSERT_EQ(window->command("time 2"), "");
    window->settle();
    EXPECT_EQ(window->state()["eye"], nlohmann::json({2, 3, 5}));
    EXPECT_EQ(difference(window->picture(), render("--time 2 --camera chase"), 0), 0);
    ASSERT_EQ(window->command("time rest"), "");
    window->settle();
    EXPECT_EQ(difference(window->picture(), render("--camera chase"), 0), 0);
}

TEST_F(Timeline, PlaysAndSteps) {
    const auto window = open_moving();
    window->key("period");
    window->key("period");
    window->key("period");
    EXPECT_EQ(timeline(*window)["time_s"], 2.0 / 24) << "the first key shows the begin of the loop";
    window->key("comma");
    window->settle();
    EXPECT_EQ(timeline(*window)["shown_s"], 1.0 / 24);
    window->click_on("step back");
    window->click_on("step back");
    EXPECT_EQ(timeline(*window)["time_s"], 48.0 / 24) << "from one end to the other";

    // The clock is the real one, whatever frames cost.
    ASSERT_EQ(window->command("loop 0.5 1.5"), "");
    ASSERT_EQ(window->command("speed 0.25"), "");
    ASSERT_EQ(window->command("time 0.5"), "");
    window->settle();
    ASSERT_EQ(window->command("state reset"), "");
    window->line("{", 1);
    const auto begin = std::chrono::steady_clock::now();
    window->key("space");
    ASSERT_TRUE(timeline(*window)["playing"]);
    std::vector<double> shown;
    double last = 0;
    double passed = 0;
    for (int i = 0; i < 14 || (shown.size() < 3 && passed < test::kHangs_s); ++i) {
        usleep(50000);
        passed = seconds_since(begin);
        const auto now = timeline(*window);
        last = now["time_s"];
        if (now["shown_s"].is_number() && (shown.empty() || now["shown_s"] != shown.back())) shown.push_back(now["shown_s"]);
    }
    const double later = seconds_since(begin);
    window->key("space");
    window->settle();
    EXPECT_GE(shown.size(), 3u) << "several poses are shown";
    if (later < 4) {  // then it has not come round
        EXPECT_TRUE(std::is_sorted(shown.begin(), shown.end()));
    }
    EXPECT_LE(last, 0.5 + 0.25 * later);
    if (clocks_count()) {
        EXPECT_GT(last, 0.5 + 0.25 * passed * 0.5);
    }
    auto now = timeline(*window);
    EXPECT_FALSE(now["playing"]);
    const double frame = double(now["time_s"]) * 24;
    EXPECT_NEAR(frame, std::round(frame), 1e-9) << "it pauses at a frame";
    EXPECT_EQ(difference(window->picture(), render("--frames " + std::to_string(std::lround(frame))), 0), 0);
    // A window that waits for the structures takes longer.
    EXPECT_LT(double(window->state()["slowest_answer_ms"]), 1e3 * at_most(0.5));

    // It comes round, and stays in the loop.
    ASSERT_EQ(window->command("speed 4"), "");
    window->click_on("play");
    EXPECT_TRUE(comes([&] {
        const double time = timeline(*window)["time_s"];
        EXPECT_GE(time, 0.5);
        EXPECT_LT(time, 1.5);
        return time < std::exchange(last, time);
    }));
    window->key("Escape");
    window->settle();
    now = timeline(*window);
    EXPECT_FALSE(now["playing"]);
    EXPECT_NEAR(double(now["time_s"]) * 24, std::round(double(now["time_s"]) * 24), 1e-9);

    // Loop and speed are steps of undo, times are not.
    EXPECT_EQ(window->state()["undo"], "Speed");
    window->key("ctrl+z");
    window->key("ctrl+z");
    window->key("ctrl+z");
    now = timeline(*window);
    EXPECT_EQ(now["loop"], nlohmann::json({0.0, 2.0}));
    EXPECT_EQ(now["speed"], 1.0);
    EXPECT_EQ(window->state()["message"], "");

    // The loop's handles.
    const Place from = window->place_of("loop end"), to{from.x - 100, from.y};
    window->drag(from, to);
    EXPECT_LT(double(timeline(*window)["loop"][1]), 1.9);
    EXPECT_EQ(window->state()["undo"], "Loop range");
}

// The samples of a picture that stands still are at times of their own, as the command line makes them.
TEST_F(Timeline, BlursWhatStandsStill) {
    const auto window = open_moving({"--spp", "8"});
    ASSERT_EQ(window->command("time 0.75"), "");
    window->settle();
    const Pixels sharp = window->picture();
    ASSERT_EQ(window->command("set shutter 1"), "");
    window->settle();
    EXPECT_EQ(window->state()["samples"], 8);
    EXPECT_GT(difference(window->picture(), sharp), 0.001);
    expect_as_command(*window);
    // Another number of samples has other times.
    ASSERT_EQ(window->command("set spp 12"), "");
    window->settle();
    expect_as_command(*window);
    EXPECT_EQ(window->state()["message"], "");
}

TEST_F(Timeline, TheCameraGoesFromKeyToKey) {
    const auto window = open_moving();
    ASSERT_EQ(window->command("time 0"), "");
    ASSERT_EQ(window->command("edit camera 0,2,7,0,0.5,0,40,0,1,0"), "");
    window->settle();
    window->click_on("camera key");
    ASSERT_EQ(window->command("time 1"), "");
    window->settle();
    EXPECT_EQ(window->state()["eye"], nlohmann::json({0, 2, 7})) << "one key: the camera rests";
    ASSERT_EQ(window->command("edit camera 2,2,7,0,0.5,0,40,0,1,0"), "");
    window->click_on("camera key");
    EXPECT_EQ(timeline(*window)["camera_keys"], nlohmann::json({0.0, 1.0}));
    ASSERT_EQ(window->command("time 0.5"), "");
    window->settle();
    EXPECT_EQ(window->state()["eye"], nlohmann::json({1, 2, 7}));
    expect_as_command(*window);
    // Between keys the camera may be moved, until another time is shown. The command then has both.
    ASSERT_EQ(window->command("edit camera 0,5,7,0,0.5,0,40,0,1,0"), "");
    window->settle();
    expect_as_command(*window);
    const std::string preset = folder.path() + "/path.json";
    ASSERT_EQ(window->command("save_preset " + preset), "");
    ASSERT_EQ(window->command("time 1"), "");
    window->settle();
    EXPECT_EQ(window->state()["eye"], nlohmann::json({2, 2, 7}));
    window->click_on("camera key");  // the camera stands on it: takes it away
    EXPECT_EQ(timeline(*window)["camera_keys"], nlohmann::json({0.0}));
    EXPECT_EQ(window->state()["undo"], "Camera path");
    window->key("ctrl+z");
    EXPECT_EQ(timeline(*window)["camera_keys"], nlohmann::json({0.0, 1.0}));
    ASSERT_EQ(window->command("camera_key remove"), "");
    ASSERT_EQ(window->command("load_preset " + preset), "");
    window->settle();
    EXPECT_EQ(timeline(*window)["camera_keys"], nlohmann::json({0.0, 1.0}));
    EXPECT_EQ(window->state()["eye"], nlohmann::json({0, 5, 7}));
}

// A scene that does not move gets a timeline with the first key.
TEST_F(Timeline, AStillSceneHasOneForItsCamera) {
    std::ofstream(scene) << "camera main eye 0 2 7\nlight point position -3 5 4\nplane\nsphere center 0 1 0\n";
    const auto window = open_moving();
    EXPECT_EQ(timeline(*window)["clips"], nlohmann::json::array());
    ASSERT_EQ(window->command("camera_key set"), "");
    window->settle();
    EXPECT_EQ(timeline(*window)["loop"], nlohmann::json({0.0, 10.0}));
    ASSERT_EQ(window->command("time 4"), "");
    window->settle();
    ASSERT_EQ(window->command("edit camera 4,2,7,0,0,0,45,0,1,0"), "");
    ASSERT_EQ(window->command("camera_key set"), "");
    ASSERT_EQ(window->command("time 2"), "");
    window->settle();
    EXPECT_EQ(window->state()["eye"], nlohmann::json({2, 2, 7}));
    expect_as_command(*window);
    const std::string line = window->query("timeline").dump();
    EXPECT_NE(line.find("\"camera_keys\":[0.0,4.0]"), std::string::npos) << line;
    EXPECT_EQ(window->state()["message"], "");
}

TEST_F(Timeline, ScrubbingWhileStructuresAreBuiltShowsOnlyWholePoses) {
    const auto window = open_moving({"--plugin", SLOW_BUILDER, "--accel", "slow_median"});
    ASSERT_EQ(window->command("moving_fps 0"), "");  // so that all pictures have all pixels
    constexpr int kTimes = 4;
    std::vector<Pixels> known = {window->picture()};  // at rest
    const auto time_of = [](int i) { return std::to_string(0.35 * i) + "5"; };
    for (int i = 1; i <= kTimes; ++i) {
        ASSERT_EQ(window->command("time " + time_of(i)), "");
        window->settle();
        known.push_back(window->picture());
        EXPECT_GT(difference(known.back(), known[known.size() - 2], 0), 0.001);
    }
    unsigned random = 7;
    int seen = 0, other = 0;
    for (int i = 0; i < 20; ++i) {
        random = random * 1664525u + 1013904223u;
        ASSERT_EQ(window->command("time " + time_of(1 + int(random >> 16) % kTimes)), "");
        const Pixels picture = window->picture();
        const bool whole =
            std::any_of(known.begin(), known.end(), [&](const Pixels& pose) { return difference(pose, picture, 0) == 0; });
        ++(whole ? seen : other);
    }
    EXPECT_EQ(other, 0) << "pictures of no pose that was asked for";
    EXPECT_GT(seen, 0);
    ASSERT_EQ(window->command("time " + time_of(2)), "");
    window->settle();
    EXPECT_EQ(difference(window->picture(), known[2], 0), 0) << "the last time counts";
    EXPECT_EQ(timeline(*window)["shown_s"], timeline(*window)["time_s"]);

    // While it plays, settings still change, and the window answers.
    ASSERT_EQ(window->command("state reset"), "");
    window->line("{", 1);
    window->key("space");
    window->key("f");
    EXPECT_NE(window->line("fps "), "");
    ASSERT_EQ(window->command("accel bvh8"), "");
    EXPECT_TRUE(window->reaches([](const nlohmann::json& state) { return state["accel"] == "bvh8"; }));
    EXPECT_TRUE(timeline(*window)["playing"]);
    window->key("space");
    window->settle();
    expect_as_command(*window);
    EXPECT_LT(double(window->state()["slowest_answer_ms"]), 1e3 * at_most(0.5));
    EXPECT_EQ(window->state()["message"], "");
    window->quit();
    EXPECT_EQ(window->exit_code(), 0);
}

TEST_F(Timeline, ACharacterWalks) {
    const std::string man = shared_path("scenes/gltf/CesiumMan.glb");
    if (man.empty()) GTEST_SKIP() << "NOT TESTED: ../shared/scenes/gltf/CesiumMan.glb is not there";
    scene = man;
    const auto window = open_moving({"--time", "0.5"});
    EXPECT_EQ(timeline(*window)["shown_s"], 0.5);
    expect_as_command(*window);
    const Pixels first = window->picture();
    window->key("space");
    EXPECT_TRUE(window->reaches([&](const nlohmann::json&) { return timeline(*window)["shown_s"] != 0.5; }));
    window->key("space");
    window->settle();
    expect_as_command(*window);
    EXPECT_GT(difference(first, window->picture()), 0.001);
}

}  // namespace
}  // namespace clarity::ui
