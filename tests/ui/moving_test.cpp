// While the camera moves, the frame rate counts more than pixels; at rest, all pixels are traced.
#include <gtest/gtest.h>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

class Moving : public WindowTest {};

TEST_F(Moving, PicturesAreReducedAndSharpenAtRest) {
    const auto window = open();
    ASSERT_EQ(window->command("moving_fps 1000"), "");  // more than any machine reaches
    ASSERT_EQ(window->command("set spp 2"), "");
    window->settle();
    // Trace a few frames, so that the time of a frame is known.
    for (int i = 0; i < 3; ++i) {
        window->key("Left");
        window->settle();
    }
    window->key_down("Left");
    const bool reduced =
        window->reaches([](const nlohmann::json& state) { return state["reduced"] && state["size"] != "320x240"; }, 30);
    window->key_up("Left");
    EXPECT_TRUE(reduced);
    window->settle();
    const auto rest = window->state();
    EXPECT_FALSE(rest["reduced"]);
    EXPECT_EQ(rest["size"], "320x240");
    EXPECT_EQ(rest["samples"], 2);
    const Pixels sharp = window->picture();
    EXPECT_EQ(sharp.width, 320);

    // The final picture equals that of a window which never moved.
    const TemporaryFolder folder;
    const std::string path = folder.path() + "/fresh.png", line = command_line(*window, path);
    ASSERT_EQ(run_command_line(line), 0) << line;
    EXPECT_EQ(difference(sharp, read_png(path), 0), 0) << line;
}

TEST_F(Moving, FullResolutionIfRequested) {
    const auto window = open();
    ASSERT_EQ(window->command("moving_fps 0"), "");
    window->key("Left");
    window->settle();
    window->key_down("Left");
    const auto begin = std::chrono::steady_clock::now();
    int seen = 0;
    for (; seconds_since(begin) < 1; ++seen) EXPECT_FALSE(window->state()["reduced"]);
    window->key_up("Left");
    EXPECT_GT(seen, 0);
    window->settle();
}

}  // namespace
}  // namespace clarity::ui
