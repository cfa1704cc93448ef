// The keys of the thesis, with real key events: each changes what it must, and nothing else.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <regex>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

class Keys : public WindowTest {
 protected:
    void SetUp() override {
        WindowTest::SetUp();
        if (!IsSkipped()) window = open();
    }
    std::unique_ptr<WindowDriver> window;
};

TEST_F(Keys, CameraKeysMoveTheCameraAndThePicture) {
    struct Case {
        const char* key;
        int axis;  // of the eye (moves) or of the target (turns)
        double sign;
        bool turns;
    };
    // The camera of the scene looks along -Z.
    const Case cases[] = {{"Left", 0, -1, false}, {"Right", 0, 1, false}, {"Up", 2, -1, false}, {"Down", 2, 1, false},
                          {"i", 1, 1, true},      {"k", 1, -1, true},     {"o", 0, -1, true},   {"p", 0, 1, true}};
    for (const Case& c : cases) {
        SCOPED_TRACE(c.key);
        const Pixels before = window->picture();
        const auto was = window->state();
        window->key(c.key);
        window->settle();
        const auto now = window->state();
        EXPECT_GT(difference(before, window->picture()), 0.01);
        const Point eye_was = was["eye"], eye = now["eye"], target_was = was["target"], target = now["target"];
        const Point& from = c.turns ? target_was : eye_was;
        const Point& to = c.turns ? target : eye;
        const auto axis = static_cast<size_t>(c.axis);
        EXPECT_GT(c.sign * (to[axis] - from[axis]), 1e-3);
        if (c.turns)
            EXPECT_LT(distance_between(eye, eye_was), 1e-6);
        else
            EXPECT_NEAR(distance_between(eye, target), distance_between(eye_was, target_was),
                        1e-4);  // the viewing direction stays
        EXPECT_EQ(now["light"], was["light"]);
    }
}

TEST_F(Keys, LightKeysMoveTheLightOnly) {
    struct Case {
        const char* key;
        size_t axis;
        double sign;
    };
    for (const Case& c : {Case{"w", 2, -1}, Case{"s", 2, 1}, Case{"a", 0, -1}, Case{"d", 0, 1}}) {
        SCOPED_TRACE(c.key);
        const Pixels before = window->picture();
        const auto was = window->state();
        for (int i = 0; i < 3; ++i) window->key(c.key);
        window->settle();
        const auto now = window->state();
        EXPECT_GT(difference(before, window->picture(), 2), 0.005);  // shading and shadows
        EXPECT_EQ(now["eye"], was["eye"]);
        EXPECT_EQ(now["target"], was["target"]);
        const Point light_was = was["light"], light = now["light"];
        EXPECT_GT(c.sign * (light[c.axis] - light_was[c.axis]), 1e-3);
        EXPECT_NEAR(light[1], light_was[1], 1e-5);
    }
}

TEST_F(Keys, FPrintsTheFrameRate) {
    window->key("Left");
    window->settle();
    window->key("f");
    const std::string line = window->line("fps ", 5);
    std::smatch match;
    ASSERT_TRUE(std::regex_search(line, match, std::regex(R"(^fps ([0-9.]+)  ([0-9.]+) ms  ([0-9.]+) Mrays/s  320x240)")))
        << line;
    const double fps = std::stod(match[1]), ms = std::stod(match[2]);
    EXPECT_GT(fps, 0.1);
    EXPECT_NEAR(fps * ms, 1000, 100);  // both values are rounded
    EXPECT_GT(std::stod(match[3]), 0.01);
}

// Counts the pixels that differ in the middle of the picture, where there is no caption.
size_t changed_pixels(const Pixels& a, const Pixels& b, const nlohmann::json& area) {
    const auto from = [&](size_t axis) { return int(double(area[axis]) + 0.2 * double(area[axis + 2])); };
    const auto to = [&](size_t axis) { return int(double(area[axis]) + 0.8 * double(area[axis + 2])); };
    size_t count = 0;
    for (int y = from(1); y < to(1); ++y)
        for (int x = from(0); x < to(0); ++x) {
            const size_t at = 3 * (size_t(y) * size_t(a.width) + size_t(x));
            int most = 0;
            for (size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(a.rgb[at + c] - b.rgb[at + c]));
            count += most > 24;
        }
    return count;
}

TEST_F(Keys, DigitsShowAndHideLevels) {
    for (const std::string accel : {"bvh2", "spheres"}) {
        SCOPED_TRACE(accel);
        ASSERT_EQ(window->command("accel " + accel), "");
        window->settle();
        const auto area = window->state()["area"];
        const Pixels plain = window->screenshot(), traced = window->picture();
        size_t volumes[3] = {};
        const char* const keys[] = {"1", "3", "0"};
        for (int i = 0; i < 3; ++i) {
            SCOPED_TRACE(keys[i]);
            window->key(keys[i]);
            window->settle();
            volumes[i] = window->state()["volumes"];
            const Pixels shown = window->screenshot();
            EXPECT_GT(changed_pixels(plain, shown, area), 200u);
            EXPECT_EQ(difference(traced, window->picture(), 0), 0);  // drawn over the picture, not traced
            window->key(keys[i]);
            window->settle();
            EXPECT_EQ(window->state()["volumes"], 0);
            EXPECT_EQ(difference(plain, window->screenshot(), 0), 0);
        }
        EXPECT_GE(volumes[0], 1u);
        EXPECT_GT(volumes[1], volumes[0]);
        EXPECT_GT(volumes[2], volumes[1]);
        // Another level replaces the level on the screen.
        window->key("1");
        window->key("2");
        window->settle();
        EXPECT_EQ(window->state()["level"], 1);
        window->key("2");
    }
}

TEST_F(Keys, AHeldKeyMovesUntilItIsReleased) {
    const Point start = window->state()["eye"];
    window->key("Right");
    window->settle();
    const Point tapped = window->state()["eye"];
    const double step = distance_between(tapped, start);
    window->key_down("Right");
    EXPECT_TRUE(
        window->reaches([&](const nlohmann::json& state) { return distance_between(state["eye"], tapped) > 3 * step; }));
    window->key_up("Right");
    window->settle();
    const Point held = window->state()["eye"];
    usleep(300000);
    window->settle();
    EXPECT_EQ(Point(window->state()["eye"]), held);
}

// // The keyboard belongs to the window or text field which has the focus.

namespace fs = std::filesystem;

class Typing : public WindowTest {
 protected:
    void type_into_path(WindowDriver& window) {
        ASSERT_EQ(window.command("focus path"), "");
        ASSERT_TRUE(window.reaches([](const nlohmann::json& state) { return bool(state["typing"]); }));
    }
    static void leave_field(WindowDriver& window) {
        const auto area = window.state()["area"];
        window.click(double(area[0]) + 20, double(area[1]) + 20);
        ASSERT_TRUE(window.reaches([](const nlohmann::json& state) { return !state["typing"]; }));
        window.settle();
    }
    static void expect_unmoved(const nlohmann::json& before, const nlohmann::json& now) {
        for (const char* key : {"eye", "target", "light", "level", "comparing", "inspect_hover", "show_lights", "bookmarks",
                                "keys_open", "browser_open", "panel_visible", "depth", "undo", "redo"})
            EXPECT_EQ(now[key], before[key]) << key;
    }
};

TEST_F(Typing, DoesNotTriggerKeys) {
    const auto window = open();
    ASSERT_EQ(window->command("set depth 3"), "");  // something to undo
    window->settle();
    const auto before = window->state();
    ASSERT_EQ(before["undo"], "Depth");
    type_into_path(*window);
    for (const char* map : {"thesis", "viewer"}) {
        ASSERT_EQ(window->command(std::string("map ") + map), "");
        window->type("wasd ikop 0123f eq cxrlgbn");
        window->settle();
        expect_unmoved(before, window->state());
    }
    const std::string typed = "wasd ikop 0123f eq cxrlgbnwasd ikop 0123f eq cxrlgbn";
    EXPECT_EQ(window->state()["path"], typed);
    EXPECT_EQ(window->line("fps ", 0.2), "");
    // Ctrl with a letter goes to the field, too.
    for (const char* key : {"ctrl+z", "ctrl+y", "ctrl+o", "ctrl+s"}) window->key(key);
    window->settle();
    expect_unmoved(before, window->state());
    EXPECT_TRUE(fs::is_empty(window->folder() + "/started_in"));

    // After the field is left, the same keys work again.
    leave_field(*window);
    window->key("ctrl+z");
    window->key("b");
    window->settle();
    EXPECT_EQ(window->state()["bookmarks"], 1);
    EXPECT_NE(window->state()["depth"], 3);
}

TEST_F(Typing, AKeyHeldBeforeIsReleasedInTheTextField) {
    const auto window = open();
    const auto before = window->state();
    window->key_down("Left");
    ASSERT_TRUE(window->reaches([&](const nlohmann::json& state) { return state["eye"] != before["eye"]; }));
    type_into_path(*window);
    window->key_up("Left");
    window->settle();
    const auto moved = window->state();
    usleep(300000);
    window->settle();
    EXPECT_EQ(window->state()["eye"], moved["eye"]);
}

// The key's release goes to the other window. The key must count as released all the same.
TEST_F(Typing, LosingTheFocusReleasesKeys) {
    const auto window = open();
    WindowDriver other({});
    other.settle();
    window->take_focus();
    const auto before = window->state();
    window->key_down("Right");
    ASSERT_TRUE(window->reaches([&](const nlohmann::json& state) { return state["eye"] != before["eye"]; }));
    other.take_focus();
    window->settle();  // with the key still down
    const auto moved = window->state();
    usleep(300000);
    window->settle();
    EXPECT_EQ(window->state()["eye"], moved["eye"]);
    window->key_up("Right");
    window->take_focus();
    usleep(300000);
    window->settle();
    EXPECT_EQ(window->state()["eye"], moved["eye"]);
    // The camera moves again at the next press.
    window->key("Right");
    window->settle();
    EXPECT_NE(window->state()["eye"], moved["eye"]);
}

}  // namespace
}  // namespace clarity::ui
