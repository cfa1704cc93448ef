// Devices that are lost while the window traces, with a driver that misbehaves on demand (tests/compile/faulty_icd.c).
#include <gtest/gtest.h>

#include <filesystem>

#include "support/scratch.hpp"
#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

class LostDevice : public WindowTest {
 protected:
    void SetUp() override {
        WindowTest::SetUp();
        scratch_.write("vendors/faulty.icd", std::string(FAULTY_DRIVER) + "\n");
        fault("");
    }
    // What the driver does from now on.
    void fault(const std::string& words) {
        scratch_.write("next", words);
        std::filesystem::rename(scratch_.path("next"), scratch_.path("fault"));
    }
    std::unique_ptr<WindowDriver> open_on_faulty() {
        return open({{"OCL_ICD_VENDORS", scratch_.path("vendors")},
                     {"CLARITY_FAULT", "other,gpu"},
                     {"CLARITY_FAULT_FILE", scratch_.path("fault")},
                     {"CLARITY_PROGRAM_CACHE", scratch_.path("programs")},
                     {"CLARITY_LAUNCH_LIMIT", "10"},  // the first launch on a busy machine may take 3 s
                     {"CLARITY_DEVICE", ""}});
    }
    static bool says(const nlohmann::json& state, const char* text) {
        return std::string(state["message"]).find(text) != std::string::npos;
    }
    Scratch scratch_;
};

TEST_F(LostDevice, ALaunchWithoutEndIsReportedAndThePictureReturns) {
    const auto window = open_on_faulty();
    const Pixels before = window->picture();
    fault("launch-endless");
    window->key("Left");
    ASSERT_TRUE(window->reaches([](const nlohmann::json& state) { return state["messages"] >= 1; }));
    EXPECT_TRUE(says(window->state(), "has not come to an end")) << window->state()["message"];
    EXPECT_TRUE(says(window->state(), "is opened anew")) << window->state()["message"];
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
    ASSERT_TRUE(window->reaches([](const nlohmann::json& state) { return state["messages"] >= 1; }));
    EXPECT_TRUE(says(window->state(), "The device is opened anew")) << window->state()["message"];
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
