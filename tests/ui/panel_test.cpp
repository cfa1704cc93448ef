// Settings changed by clicks in the panel and by the script: each gives the right new picture.
#include <gtest/gtest.h>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

using Clock = std::chrono::steady_clock;

class Panel : public WindowTest {};

TEST_F(Panel, ClicksChangeSettings) {
    const auto window = open();
    const Pixels deep = window->picture();
    window->click_on("Depth", 0.02);
    window->settle();
    EXPECT_EQ(window->state()["depth"], 1);
    const Pixels flat = window->picture();
    EXPECT_GT(difference(deep, flat), 0.02);  // mirrors and glass turn dark

    window->click_on("Shadows", 0.03);
    window->settle();
    EXPECT_GT(difference(flat, window->picture()), 0.01);
    window->click_on("Shadows", 0.03);
    window->settle();
    EXPECT_EQ(difference(flat, window->picture(), 1), 0);

    window->click_on("Structure");
    window->settle();
    window->click_on("Bounding spheres (thesis)");
    window->settle();
    EXPECT_EQ(window->state()["accel"], "spheres");
    // Pixels at silhouettes may differ.
    EXPECT_LT(difference(flat, window->picture(), 1), 1e-3);

    window->click_on("Packet", 0.96);
    window->settle();
    window->click_on("8x8");
    window->settle();
    EXPECT_EQ(window->state()["packet"], "8x8");
    EXPECT_LT(difference(flat, window->picture(), 1), 1e-3);
}

TEST_F(Panel, PicturesDoNotDependOnHowTheyAreTraced) {
    const auto window = open();
    const Pixels reference = window->picture();
    for (const char* change :
         {"set packet 8x2", "set lanes 4", "accel linear", "accel spheres,max_leaf=8", "set packet 1x1", "set lanes 1"}) {
        SCOPED_TRACE(change);
        ASSERT_EQ(window->command(change), "");
        window->settle();
        EXPECT_LT(difference(reference, window->picture(), 1), 1e-3);
        EXPECT_EQ(window->state()["message"], "");
        EXPECT_FALSE(window->state()["behind"]);
    }
    ASSERT_EQ(window->command("set size 200x100"), "");
    window->settle();
    const Pixels small = window->picture();
    EXPECT_EQ(small.width, 200);
    EXPECT_EQ(small.height, 100);
}

TEST_F(Panel, SamplesAccumulateWhileTheCameraRests) {
    const auto window = open();
    ASSERT_EQ(window->command("set spp 1"), "");
    window->settle();
    EXPECT_EQ(window->state()["samples"], 1);
    const Pixels one = window->picture();
    ASSERT_EQ(window->command("set spp 8"), "");
    window->settle();
    EXPECT_EQ(window->state()["samples"], 8);
    const Pixels eight = window->picture();
    EXPECT_GT(difference(one, eight), 1e-3);  // edges are smoothed
    EXPECT_LT(difference(one, eight, 128), 0.05);
    window->key("Left");
    window->settle();
    EXPECT_EQ(window->state()["samples"], 8);
}

TEST_F(Panel, RefusedValuesChangeNothing) {
    const auto window = open();
    const auto before = window->state();
    EXPECT_NE(window->command("set depth 999"), "");
    EXPECT_NE(window->command("set packet 3"), "");
    EXPECT_NE(window->command("accel nothing"), "");
    EXPECT_NE(window->command("accel bvh2,max_leaf=-4"), "");
    window->settle();
    const auto after = window->state();
    for (const char* key : {"depth", "packet", "accel"}) EXPECT_EQ(after[key], before[key]) << key;
}

// The requirement is 2 s on the idle reference machine. This bound leaves room for a busy machine.
TEST_F(Panel, PacketSizeChangesQuicklyWithAColdCache) {
    const TemporaryFolder cache;
    const auto window = open({{"POCL_CACHE_DIR", cache.path()}, {"XDG_CACHE_HOME", cache.path()}});
    const auto begin = Clock::now();
    ASSERT_EQ(window->command("set packet 8x8"), "");
    window->settle();
    const double seconds = seconds_since(begin);
    EXPECT_EQ(window->state()["packet"], "8x8");
    std::printf("packet 4x4 to 8x8, compiler's cache empty at start: %.2f s\n", seconds);
    RecordProperty("packet_change_ms", int(seconds * 1e3));
    EXPECT_LT(seconds, 6);
}

}  // namespace
}  // namespace clarity::ui
