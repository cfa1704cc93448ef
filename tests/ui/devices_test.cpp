// Devices changed while the window runs. PoCL can show one processor as several devices; other drivers may have only one.
#include <gtest/gtest.h>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

class Devices : public WindowTest {};

TEST_F(Devices, CanBeSwitchedWhileRendering) {
    const auto window = open({{"POCL_DEVICES", "pthread basic"}});
    const auto was = window->state();
    const std::string first = was["device"], second = first == "0:0" ? "0:1" : "0:0";
    const Pixels before = window->picture();
    ASSERT_EQ(window->command("device " + second), "");
    window->settle();
    if (window->state()["device"] == first) {
        EXPECT_NE(window->state()["message"], "");
        GTEST_SKIP() << "NOT TESTED: no second OpenCL device, " << std::string(window->state()["message"]);
    }
    EXPECT_EQ(window->state()["device"], second);
    EXPECT_EQ(window->state()["message"], "");
    EXPECT_LT(difference(before, window->picture(), 1), 1e-3);
    window->key("Left");
    window->settle();
    EXPECT_GT(difference(before, window->picture()), 0.01);
    // The change can be undone like any other setting.
    window->key("Home");
    window->key("ctrl+z");
    window->settle();
    EXPECT_EQ(window->state()["device"], first);
    EXPECT_EQ(difference(before, window->picture(), 0), 0);

    // Each side on a device of its own.
    ASSERT_EQ(window->command("compare b"), "");
    ASSERT_EQ(window->command("device " + second), "");
    window->settle();
    EXPECT_LT(double(window->state()["difference"]["share"]), 1e-3);
    EXPECT_EQ(window->state()["message"], "");
}

TEST_F(Devices, AMissingDeviceGivesAMessage) {
    const auto window = open();
    const Pixels before = window->picture();
    const auto was = window->state();
    for (const char* choice : {"99:99", "no such device"}) {
        ASSERT_EQ(window->command(std::string("device ") + choice), "");
        window->settle();
        EXPECT_NE(std::string(window->state()["message"]).find(choice), std::string::npos) << window->state()["message"];
        EXPECT_EQ(window->state()["device"], was["device"]);
        EXPECT_EQ(difference(before, window->picture(), 0), 0);
    }
    window->key("Left");
    window->settle();
    EXPECT_GT(difference(before, window->picture()), 0.01);
    // Other settings still apply, on the device that is there.
    ASSERT_EQ(window->command("set lanes 4"), "");
    window->settle();
    EXPECT_EQ(window->state()["lanes"], 4);
    ASSERT_EQ(window->command("device " + std::string(was["device"])), "");
    window->settle();
    EXPECT_EQ(window->state()["message"], "");
    EXPECT_FALSE(window->state()["behind"]);
}

// A CPU split into two devices which share each picture. The picture stays the same.
TEST_F(Devices, SeveralShareAPicture) {
    const auto window = open();
    const std::string first = window->state()["device"];
    const Pixels before = window->picture();
    ASSERT_EQ(window->command("device " + first + "/2"), "");
    window->settle();
    if (window->state()["device"] == first) GTEST_SKIP() << "NOT TESTED: " << std::string(window->state()["message"]);
    EXPECT_EQ(window->state()["message"], "");
    EXPECT_EQ(window->state()["device"], first + "/2.0," + first + "/2.1");
    EXPECT_EQ(difference(before, window->picture(), 0), 0);
    // Motion, refinement, other AOVs, a pixel's rays and an edit work as with one device.
    window->key("Left");
    window->settle();
    EXPECT_GT(difference(before, window->picture()), 0.01);
    const Pixels moved = window->picture();
    for (const char* words : {"set aov t", "set aov color", "set spp 4", "set lanes 4", "set depth 2"}) {
        ASSERT_EQ(window->command(words), "");
        window->settle();
        EXPECT_EQ(window->state()["message"], "") << words;
    }
    for (const char* words : {"set spp 16", "set lanes auto", "set depth 5"}) ASSERT_EQ(window->command(words), "");
    ASSERT_EQ(window->command("device " + first), "");
    window->settle();
    EXPECT_EQ(window->state()["device"], first);
    EXPECT_EQ(difference(moved, window->picture(), 0), 0);
}

}  // namespace
}  // namespace clarity::ui
