// The keyboard belongs to the window or text field which has the focus.
#include <gtest/gtest.h>

#include <filesystem>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

namespace fs = std::filesystem;

class Typing : public WindowTest {
 protected:
    void type_into_path(WindowDriver& window) {
        ASSERT_EQ(window.command("focus path"), "");
        ASSERT_TRUE(window.reaches([](const nlohmann::json& state) { return bool(state["typing"]); }, 20));
    }
    static void leave_field(WindowDriver& window) {
        const auto area = window.state()["area"];
        window.click(double(area[0]) + 20, double(area[1]) + 20);
        ASSERT_TRUE(window.reaches([](const nlohmann::json& state) { return !state["typing"]; }, 20));
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
    ASSERT_TRUE(window->reaches([&](const nlohmann::json& state) { return state["eye"] != before["eye"]; }, 20));
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
    ASSERT_TRUE(window->reaches([&](const nlohmann::json& state) { return state["eye"] != before["eye"]; }, 20));
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
