// Devices that are lost while the window traces, with a driver that misbehaves on demand (tests/compile/faulty_icd.c).
#include <gtest/gtest.h>

#include "ui/driver/faulty_driver.hpp"

namespace clarity::ui {
namespace {

class LostDevice : public FaultyDriverTest {
 protected:
    std::unique_ptr<WindowDriver> open_on_faulty() {
        // The first launch on a busy machine may take 3 s.
        return FaultyDriverTest::open_on_faulty("other,gpu", {{"CLARITY_LAUNCH_LIMIT", "10"}});
    }
    static bool says(const nlohmann::json& state, const char* text) {
        return std::string(state["message"]).find(text) != std::string::npos;
    }
    // What is done about a loss is added to its message once the thread that prepares scenes is idle: some frames later.
    static void expect_message(WindowDriver& window, const char* text) {
        EXPECT_TRUE(window.reaches([&](const nlohmann::json& state) { return says(state, text); }))
            << window.state()["message"];
    }
};

TEST_F(LostDevice, ALaunchWithoutEndIsReportedAndThePictureReturns) {
    const auto window = open_on_faulty();
    const Pixels before = window->picture();
    fault("launch-endless");
    window->key("Left");
    expect_message(*window, "has not come to an end");
    expect_message(*window, "is opened anew");
    fault("");
    window->key("Home");  // the device may have been lost a second time before the fault was gone
    ASSERT_TRUE(window->reaches([](const nlohmann::json& state) { return !state["behind"]; }));
    window->settle();
    EXPECT_EQ(difference(before, window->picture(), 0), 0);
    window->key("Left");
    window->settle();
    EXPECT_GT(difference(before, window->picture()), 0.01);
    window->quit();
    EXPECT_EQ(window->exit_code(), 0);
}

TEST_F(LostDevice, SettingsOfTheLastPictureReturn) {
    const auto window = open_on_faulty();
    ASSERT_EQ(window->command("set depth 3"), "");
    window->settle();
    const Pixels before = window->picture();
    fault("launch-endless");
    ASSERT_EQ(window->command("accel linear"), "");
    expect_message(*window, "The device is opened anew");
    fault("");
    window->key("Left");  // the device may have been lost a second time before the fault was gone
    window->key("Home");
    ASSERT_TRUE(window->reaches([&](const nlohmann::json& state) { return !state["behind"] && state["accel"] != "linear"; }));
    window->settle();
    EXPECT_EQ(window->state()["depth"], 3);
    EXPECT_EQ(difference(before, window->picture(), 0), 0);
}

TEST_F(LostDevice, ADriverThatFailsIsOpenedAnew) {
    const auto window = open_on_faulty();
    const Pixels before = window->picture();
    for (const char* error : {"enqueue=-2@1", "enqueue=-34@1", "read=-36@1"}) {
        const int messages = window->state()["messages"];
        fault(error);
        window->key("Left");
        ASSERT_TRUE(window->reaches([&](const nlohmann::json& state) { return state["messages"] > messages; })) << error;
        EXPECT_TRUE(says(window->state(), "failed with OpenCL error")) << window->state()["message"];
        fault("");
        window->key("Home");
        window->settle();
        EXPECT_EQ(difference(before, window->picture(), 0), 0) << error;
    }
}

// A refused launch may be refused once. Several in a row mean that the device has failed.
TEST_F(LostDevice, ADeviceThatRefusesEverythingIsOpenedAnew) {
    const auto window = open_on_faulty();
    const Pixels before = window->picture();
    fault("enqueue=-5@1");
    int refused = 0;
    for (; refused < 6 && !says(window->state(), "opened anew"); ++refused) {
        const int messages = window->state()["messages"];
        window->key(refused % 2 ? "Right" : "Left");
        ASSERT_TRUE(window->reaches([&](const nlohmann::json& state) { return state["messages"] > messages; })) << refused;
    }
    EXPECT_GE(refused, 2);
    EXPECT_TRUE(says(window->state(), "opened anew")) << window->state()["message"];
    fault("");
    window->key("Left");
    window->key("Home");
    window->settle();
    EXPECT_EQ(difference(before, window->picture(), 0), 0);
}

}  // namespace
}  // namespace clarity::ui
