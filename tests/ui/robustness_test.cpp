// How the window starts, ends and remembers; and that the last of many wishes counts.
#include <gtest/gtest.h>

#include <filesystem>

#include "window_fixture.hpp"

namespace clarity {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

class Window : public WindowTest {};

TEST_F(Window, ManyChangesAtOnceEndInTheLast) {
    const auto window = open();
    for (int round = 0; round < 10; ++round)
        for (const char* change :
             {"accel spheres", "set lanes 4", "set depth 2", "accel bvh2", "set lanes auto", "set depth 4"})
            window->send(change);
    window->settle(180);
    const auto now = window->state();
    EXPECT_EQ(now["accel"], "bvh2");
    EXPECT_EQ(now["depth"], 4);
    EXPECT_EQ(now["message"], "");
    EXPECT_FALSE(now["behind"]);
}

TEST_F(Window, SaysHowToRenderWithoutADisplay) {
    WindowDriver window({source_path("scenes/primitives.scene")}, {{"DISPLAY", ""}});
    const auto begin = Clock::now();
    while (window.running() && seconds_since(begin) < 20) usleep(20000);
    EXPECT_EQ(window.exit_code(), 2);
    EXPECT_NE(window.errors().find("clarity render"), std::string::npos) << window.errors();
    // A display that is named and not there.
    WindowDriver gone({source_path("scenes/primitives.scene")}, {{"DISPLAY", ":4711"}});
    while (gone.running() && seconds_since(begin) < 40) usleep(20000);
    EXPECT_EQ(gone.exit_code(), 2);
    EXPECT_NE(gone.errors().find("clarity render"), std::string::npos) << gone.errors();
}

TEST_F(Window, RemembersUnderTheConfigurationFolderOnly) {
    const TemporaryFolder config;
    {
        const auto window = open({{"CLARITY_UI_NO_SAVE", ""}, {"XDG_CONFIG_HOME", config.path()}});
        ASSERT_EQ(window->command("map viewer"), "");
        window->quit();
        EXPECT_EQ(window->exit_code(), 0);
        EXPECT_TRUE(fs::is_empty(window->folder() + "/started_in"));
        EXPECT_TRUE(fs::exists(config.path() + "/clarity/window.json"));
    }
    {
        const auto window = open({{"CLARITY_UI_NO_SAVE", ""}, {"XDG_CONFIG_HOME", config.path()}});
        EXPECT_EQ(window->state()["map"], "viewer");
    }
    const TemporaryFolder untouched;
    const auto window = open({{"XDG_CONFIG_HOME", untouched.path()}});
    window->quit();
    EXPECT_TRUE(fs::is_empty(untouched.path()));
}

}  // namespace
}  // namespace clarity
