// Sequences of pictures, and how they end.
#include <gtest/gtest.h>

#include <filesystem>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

namespace fs = std::filesystem;

class SequenceOf : public WindowTest {
 protected:
    size_t files() const {
        size_t count = 0;
        for (const auto& entry : fs::directory_iterator(folder.path())) count += entry.is_regular_file();
        return count;
    }
    TemporaryFolder folder;
};

TEST_F(SequenceOf, ATurntableWritesEveryPicture) {
    const auto window = open_scene(source_path("scenes/cornell.scene"), "96x72");
    const auto was = window->state();
    const Pixels still = window->picture();
    ASSERT_EQ(window->command("turntable 5 " + folder.path() + "/turn_####.png"), "");
    window->settle();
    EXPECT_EQ(files(), 5u);
    Pixels last;
    for (int i = 1; i <= 5; ++i) {
        const Pixels picture = read_png(folder.path() + "/turn_000" + std::to_string(i) + ".png");
        EXPECT_EQ(difference(still, picture, 0) == 0, i == 1) << i;
        EXPECT_TRUE(i == 1 || difference(last, picture) > 0.05) << i;
        last = picture;
    }
    EXPECT_EQ(window->state()["eye"], was["eye"]);
    EXPECT_EQ(difference(still, window->picture(), 0), 0);
    EXPECT_EQ(window->state()["message"], "");
}

TEST_F(SequenceOf, EscapeStopsItAndTheCameraComesBack) {
    const auto window = open_scene(source_path("scenes/cornell.scene"), "96x72");
    const auto was = window->state();
    ASSERT_EQ(window->command("turntable 2000 " + folder.path() + "/turn_####.png"), "");
    ASSERT_TRUE(window->reaches([&](const nlohmann::json&) { return files() >= 3; }));
    window->key("Escape");
    window->settle();
    const size_t written = files();
    EXPECT_LT(written, 2000u);
    EXPECT_EQ(window->state()["eye"], was["eye"]);
    usleep(300000);
    EXPECT_EQ(files(), written);
    // Another sequence can follow.
    ASSERT_EQ(window->command("turntable 2 " + folder.path() + "/again_####.png"), "");
    window->settle();
    EXPECT_EQ(files(), written + 2);
    EXPECT_EQ(window->state()["message"], "");
}

// The first frame of the replaced sequence waits for more samples than there is time for.
TEST_F(SequenceOf, AnotherOneReplacesOneWhoseFrameIsPending) {
    const auto window = open_scene(source_path("scenes/cornell.scene"), "96x72");
    const auto was = window->state();
    ASSERT_EQ(window->command("set spp 65536"), "");
    ASSERT_EQ(window->command("turntable 5 " + folder.path() + "/first_####.png"), "");
    ASSERT_EQ(window->command("state"), "");
    ASSERT_EQ(window->command("turntable 3 " + folder.path() + "/second_####.png"), "");
    ASSERT_EQ(window->command("state"), "");
    // The same sequence again: it must not take the outcome of the first one's save for its own.
    ASSERT_EQ(window->command("turntable 3 " + folder.path() + "/second_####.png"), "");
    ASSERT_EQ(window->command("set spp 1"), "");
    window->settle();
    EXPECT_EQ(files(), 3u);
    const Pixels still = read_png(folder.path() + "/second_0001.png");
    EXPECT_EQ(difference(still, window->picture(), 0), 0);
    EXPECT_GT(difference(still, read_png(folder.path() + "/second_0002.png"), 0), 0);
    EXPECT_EQ(window->state()["eye"], was["eye"]);
    EXPECT_EQ(window->state()["message"], "");
}

TEST_F(SequenceOf, APendingFrameIsNotWrittenAfterAStop) {
    const auto window = open_scene(source_path("scenes/cornell.scene"), "96x72");
    const auto was = window->state();
    ASSERT_EQ(window->command("turntable 2000 " + folder.path() + "/turn_####.png"), "");
    ASSERT_TRUE(window->reaches([&](const nlohmann::json&) { return files() >= 3; }));
    ASSERT_EQ(window->command("set spp 65536"), "");
    ASSERT_EQ(window->command("state"), "");
    const size_t written = files();
    window->key("Escape");
    ASSERT_TRUE(window->reaches([&](const nlohmann::json& state) { return state["eye"] == was["eye"]; }));
    ASSERT_EQ(window->command("set spp 1"), "");
    window->settle();
    EXPECT_LE(files(), written + 1);  // one may have been in the middle of being written
    const Pixels still = window->picture();
    for (size_t i = 2; i <= files(); ++i) {
        char name[32];
        std::snprintf(name, sizeof name, "/turn_%04zu.png", i);
        EXPECT_GT(difference(still, read_png(folder.path() + name), 0), 0) << name << " shows the restored camera";
    }
    EXPECT_EQ(window->state()["eye"], was["eye"]);
}

TEST_F(SequenceOf, RefusesUnwritablePaths) {
    const auto window = open_scene(source_path("scenes/cornell.scene"), "96x72");
    const auto was = window->state();
    EXPECT_NE(window->command("turntable 5 " + folder.path() + "/one.png").find("####"), std::string::npos);
    EXPECT_NE(window->command("turntable 5 " + folder.path() + "/no/folder_####.png"), "");
    EXPECT_NE(window->command("turntable 0 " + folder.path() + "/turn_####.png"), "");
    EXPECT_NE(window->command("turntable 5 " + folder.path() + "/turn_####.jpeg"), "");
    window->settle();
    EXPECT_EQ(window->state()["eye"], was["eye"]);
    EXPECT_EQ(files(), 0u);
}

}  // namespace
}  // namespace clarity::ui
