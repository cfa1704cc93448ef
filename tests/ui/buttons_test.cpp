// The first clicks of a new user: open a file, save the picture, show the volumes, compare two structures, undo.
#include <gtest/gtest.h>

#include <filesystem>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

namespace fs = std::filesystem;

class Buttons : public WindowTest {
 protected:
    static bool reaches(WindowDriver& window, const std::string& key, const nlohmann::json& value) {
        return window.reaches([&](const nlohmann::json& state) { return state[key] == value; }, 20);
    }
};

TEST_F(Buttons, ToolbarButtonsWork) {
    const auto window = open();
    window->click_on("Volumes");
    EXPECT_TRUE(window->reaches([](const nlohmann::json& state) { return state["level"] != -1 && state["volumes"] > 0; }, 20));
    window->click_on("Volumes");
    EXPECT_TRUE(reaches(*window, "level", -1));
    window->click_on("Inspect");
    EXPECT_TRUE(reaches(*window, "inspect_hover", true));
    window->click_on("Inspect");
    EXPECT_TRUE(reaches(*window, "inspect_hover", false));
    window->click_on("Compare");
    EXPECT_TRUE(reaches(*window, "comparing", true));
    window->click_on("Compare");
    EXPECT_TRUE(reaches(*window, "comparing", false));
    window->settle();
    const fs::path saved = fs::path(window->folder()) / "started_in/clarity_0001.png";
    window->click_on("Save");
    window->settle();
    ASSERT_TRUE(fs::exists(saved)) << window->errors();
    EXPECT_EQ(difference(window->picture(), read_png(saved), 0), 0);
    EXPECT_EQ(window->state()["message"], "");
}

TEST_F(Buttons, UndoAndRedo) {
    const auto window = open();
    const int depth = window->state()["depth"];
    ASSERT_EQ(window->command("set depth 1"), "");
    ASSERT_TRUE(reaches(*window, "undo", "Depth"));
    window->click_on("undo");
    EXPECT_TRUE(reaches(*window, "depth", depth));
    window->click_on("redo");
    EXPECT_TRUE(reaches(*window, "depth", 1));
}

// Parts of the light of `path` have a button for each value; another press of the same button changes nothing.
TEST_F(Buttons, ShowPartsOfTheLightOfPaths) {
    const auto window = open_scene(source_path("scenes/primitives.scene"), "320x800");
    ASSERT_EQ(window->command("set tracer path"), "");
    window->settle();
    const struct {
        const char *label, *word;
    } presses[] = {
        {"found", "only_by=bsdf"}, {"found", "only_by=bsdf"}, {"glossy", "only_first=glossy"}, {"seen", "only_bounce=0"}};
    for (const auto& press : presses) {
        window->click_on(press.label);
        window->settle();
        EXPECT_NE(desired(*window).find(press.word), std::string::npos) << press.label << ": " << desired(*window);
    }
}

// Files are opened by their path and by a click on their name.
TEST_F(Buttons, TheBrowserOpensFiles) {
    const TemporaryFolder folder;
    for (const char* name : {"first.scene", "second.scene"})
        std::ofstream(folder.path() + "/" + name) << "sphere center 0 0 0 radius 1\n";
    const auto window = open();
    window->click_on("Open\u2026");
    ASSERT_TRUE(reaches(*window, "browser_open", true));
    ASSERT_TRUE(reaches(*window, "typing", true));
    window->type(folder.path() + "/first.scene");
    window->tap("Return");
    EXPECT_TRUE(reaches(*window, "files", nlohmann::json::array({folder.path() + "/first.scene"})));
    EXPECT_TRUE(reaches(*window, "browser_open", false));
    window->settle();
    // A part of the name is enough to find the file.
    window->key("ctrl+o");
    ASSERT_TRUE(reaches(*window, "browser_open", true));
    ASSERT_TRUE(reaches(*window, "typing", true));
    window->type(folder.path() + "/seco");
    window->settle();
    window->double_click(window->place_of("second.scene"));
    EXPECT_TRUE(reaches(*window, "files", nlohmann::json::array({folder.path() + "/second.scene"})));
    EXPECT_EQ(window->state()["message"], "");
}

// The command line goes to the clipboard, and from there into a text field.
TEST_F(Buttons, TheCommandLineIsCopied) {
    const auto window = open();
    ASSERT_EQ(window->command("set depth 2"), "");
    window->settle();
    window->click_on("Copy command line");
    ASSERT_EQ(window->command("focus path"), "");
    ASSERT_TRUE(reaches(*window, "typing", true));
    window->tap("ctrl+v");
    EXPECT_TRUE(reaches(*window, "path", command_line(*window, "picture.png")));
}

}  // namespace
}  // namespace clarity::ui
