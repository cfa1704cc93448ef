// Devices that are lost while the window traces, with a driver that misbehaves on demand (tests/compile/faulty_icd.c).
#include <gtest/gtest.h>

#include <chrono>

#include "ui/driver/faulty_driver.hpp"

namespace clarity::ui {
namespace {

class LostDevice : public FaultyDriverTest {
 protected:
    std::unique_ptr<WindowDriver> open_on_faulty() {
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

// // Every fault of a driver, in the window (tests/compile/faulty_icd.c): keys are answered meanwhile, the user reads what
// happened, and the picture returns when the fault is gone. Prints a row for each: docs/debugging.md has such a table.

// words: for the driver. trigger: the script's line that makes the window meet the fault. says: part of what is read then.
struct Fault {
    const char *words, *trigger, *says;
};

class DriverFaults : public FaultyDriverTest {
 protected:
    std::unique_ptr<WindowDriver> open_on_faulty(const char* always) {
        return FaultyDriverTest::open_on_faulty(always, {{"CLARITY_COMPILE", ""},
                                                         {"CLARITY_COMPILE_PATIENCE", "2"},
                                                         {"CLARITY_COMPILE_MEMORY", "1500"},
                                                         {"CLARITY_LAUNCH_LIMIT", "10"}});
    }
    static bool says(const nlohmann::json& state, const std::string& text) {
        for (const char* place : {"message", "stage"})
            if (std::string(state[place]).find(text) != std::string::npos) return true;
        return false;
    }
    // The fault comes, and the trigger makes the window meet it.
    void meet_it(WindowDriver& window, const Fault& one) {
        ASSERT_EQ(window.command("state reset"), "");
        window.line("{", 1);
        fault(one.words);
        ASSERT_EQ(window.command(one.trigger), "");
        nlohmann::json state;
        const auto begin = std::chrono::steady_clock::now();
        do {
            window.key("f");
            ASSERT_NE(window.line("fps "), "") << one.words << ": keys are not answered";
            state = window.state();
        } while (!says(state, one.says) && seconds_since(begin) < test::kHangs_s);
        std::printf("%-18s | %4.1f s | %3.0f ms | %s\n", one.words, seconds_since(begin), double(state["slowest_answer_ms"]),
                    (std::string(state["message"]) + " / " + std::string(state["stage"])).c_str());
        EXPECT_TRUE(says(state, one.says)) << one.words << ": " << state["message"] << state["stage"];
        // A busy machine may delay us for a moment. A window that waits for the driver takes longer than this.
        EXPECT_LT(double(state["slowest_answer_ms"]), 1e3 * at_most(1)) << one.words;
    }
    // Likewise. Then the fault is gone, and the window has the picture that it had before.
    void meet(WindowDriver& window, const Fault& one) {
        const nlohmann::json was = window.state();
        const Pixels before = window.picture();
        meet_it(window, one);
        window.key("Escape");
        fault("");
        ASSERT_EQ(window.command("accel " + std::string(was["accel"])), "");
        ASSERT_EQ(window.command("set depth " + std::to_string(int(was["depth"]))), "");
        window.key("Left");  // a device that was lost twice is opened anew when the view changes
        window.key("Home");
        ASSERT_TRUE(window.reaches([](const nlohmann::json& now) { return !now["behind"] && !now["busy"]; })) << one.words;
        window.settle();
        EXPECT_EQ(difference(before, window.picture(), 0), 0) << one.words;
    }
};

TEST_F(DriverFaults, OfTheCompiler) {
    const auto window = open_on_faulty("");
    for (const Fault& one :
         {Fault{"build-hangs", "accel linear", "has been at work"}, Fault{"build-crashes", "accel bvh4", "compiler crashed"},
          Fault{"build-exits", "accel cwbvh", "ended its process"}, Fault{"build-eats", "accel spheres", "needs more than"},
          Fault{"build-refuses", "accel bvh2", "OpenCL error -11"}})
        meet(*window, one);
}

TEST_F(DriverFaults, OfADevice) {
    const auto window = open_on_faulty("other,gpu");
    for (const Fault& one :
         {Fault{"enqueue=-5@1", "set depth 2", "OpenCL error -5"}, Fault{"enqueue=-4@1", "set depth 2", "out of memory"},
          Fault{"buffer=-4@1", "accel linear", "no room on"}, Fault{"read=-36@1", "set depth 2", "OpenCL error -36"},
          Fault{"launch-endless", "set depth 2", "has not come to an end"}})
        meet(*window, one);
}

// Nothing stops a launch on a CPU. The window says so, and closes.
TEST_F(DriverFaults, ALaunchThatHangs) {
    const auto window = open_on_faulty("");
    meet_it(*window, {"launch-hangs", "set depth 2", "no sign of life"});
    const auto begin = std::chrono::steady_clock::now();
    window->quit();
    EXPECT_EQ(window->exit_code(), 0);
    EXPECT_LT(seconds_since(begin), at_most(5 + 10));
    EXPECT_NE(window->errors().find("did not stop within 5 s after the window was closed"), std::string::npos)
        << window->errors();
}

}  // namespace
}  // namespace clarity::ui
