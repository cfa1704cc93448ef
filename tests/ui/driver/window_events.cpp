// The part of the driver that stands for a user's hands: key and mouse events through xdotool.
#include <gtest/gtest.h>
#include <signal.h>

#include <cmath>
#include <cstdlib>

#include "window_driver.hpp"

namespace clarity::ui {
namespace {

std::string at(const Place& place) {
    return std::to_string(std::lround(place.x)) + " " + std::to_string(std::lround(place.y));
}

std::string number(Button button) {
    return std::to_string(static_cast<int>(button));
}

}  // namespace

void WindowDriver::xdotool(const std::string& arguments) {
    const std::string text = "DISPLAY=" + VirtualScreen::instance().display() + " xdotool " + arguments;
    ASSERT_EQ(std::system(text.c_str()), 0) << text;
}

void WindowDriver::key(const std::string& name) {
    xdotool("key --delay 0 " + name);
}
void WindowDriver::key_down(const std::string& name) {
    xdotool("keydown " + name);
}
void WindowDriver::key_up(const std::string& name) {
    xdotool("keyup " + name);
}
void WindowDriver::tap(const std::string& name) {
    key_down(name);
    pass_frame();
    key_up(name);
    pass_frame();
}
void WindowDriver::type(const std::string& text) {
    xdotool("type --delay 20 '" + text + "'");
}

// Waits until the window has drawn the effect of the last event. Dear ImGui 1.86 reads the mouse once a frame, and a busy
// machine draws few frames. Each turn of the window's loop runs one script line before its frame. So after the third line, one
// whole turn began and ended after the event.
void WindowDriver::pass_frame() {
    for (int i = 0; i < 3; ++i) EXPECT_EQ(command("# next"), "");
}

void WindowDriver::mouse(const std::string& event) {
    xdotool(event);
    pass_frame();
}

void WindowDriver::move(const Place& to) {
    mouse("mousemove " + at(to));
}

void WindowDriver::click(double x, double y) {
    click(Place{x, y});
}

void WindowDriver::click(const Place& place, Button button) {
    move(place);
    mouse("mousedown " + number(button));
    mouse("mouseup " + number(button));
}

namespace {

constexpr const char* kPatient = "double_click 60";  // seconds between its clicks: a busy machine pulls them apart
constexpr const char* kUsual = "double_click 0";

}  // namespace

void WindowDriver::double_click(const Place& place) {
    move(place);
    EXPECT_EQ(command(kPatient), "");
    for (int click = 0; click < 2; ++click) {
        mouse("mousedown 1");
        mouse("mouseup 1");
    }
    EXPECT_EQ(command(kUsual), "");
}

// A stopped process draws no frames, and the X server keeps the events for it.
void WindowDriver::double_click_in_one_frame(const Place& place) {
    move(place);
    ASSERT_EQ(command(kPatient), "");
    ASSERT_EQ(kill(pid_, SIGSTOP), 0);
    xdotool("click --repeat 2 --delay 60 1");
    ASSERT_EQ(kill(pid_, SIGCONT), 0);
    for (int i = 0; i < 2; ++i) pass_frame();  // a press and a release a frame
    ASSERT_EQ(command(kUsual), "");
}

void WindowDriver::drag(const Place& from, const Place& to, Button button) {
    move(from);
    mouse("mousedown " + number(button));
    constexpr int kSteps = 4;
    for (int i = 1; i <= kSteps; ++i) {
        const double share = double(i) / kSteps;
        move({from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)});
    }
    mouse("mouseup " + number(button));
}

void WindowDriver::wheel(const Place& place, int steps) {
    move(place);
    for (int i = 0; i < std::abs(steps); ++i) mouse(steps > 0 ? "click 4" : "click 5");
}

void WindowDriver::click_on(const std::string& label, double at) {
    click(place_of(label, at));
}

// A row that is scrolled out of sight is scrolled into view when a test asks for it.
Place WindowDriver::place_of(const std::string& label, double at) {
    std::string error;
    for (int i = 0; i < 5; ++i) {
        error = command("find " + label);
        if (!error.empty()) {
            pass_frame();
            continue;
        }
        const nlohmann::json place = nlohmann::json::parse(line("{"));
        return {double(place["x"]) + at * double(place["w"]), double(place["y"]) + double(place["h"]) / 2};
    }
    ADD_FAILURE() << error;
    return {};
}

Place WindowDriver::place_of_pixel(double x, double y, size_t picture) {
    const nlohmann::json layout = query("layout");
    const std::string size = state()["size"];
    const double width = std::stod(size), height = std::stod(size.substr(size.find('x') + 1));
    if (layout["places"].size() <= picture) {
        ADD_FAILURE() << "there is no picture " << picture;
        return {};
    }
    const auto area = layout["places"][picture]["area"];
    return {double(area[0]) + (x + 0.5) / width * double(area[2]), double(area[1]) + (y + 0.5) / height * double(area[3])};
}

void WindowDriver::take_focus() {
    xdotool("search --sync --onlyvisible --all --pid " + std::to_string(pid_) + " --class clarity windowfocus --sync");
    pass_frame();
}

}  // namespace clarity::ui
