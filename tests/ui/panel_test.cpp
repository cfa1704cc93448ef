// Settings changed by clicks in the panel and by the script: each gives the right new picture.
#include <gtest/gtest.h>

#include <filesystem>

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

// The requirement is 2 s on the idle reference machine.
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
    EXPECT_LT(seconds, at_most(6));
}

// // The first clicks of a new user: open a file, save the picture, show the volumes, compare two structures, undo.

namespace fs = std::filesystem;

class Buttons : public WindowTest {
 protected:
    static bool reaches(WindowDriver& window, const std::string& key, const nlohmann::json& value) {
        return window.reaches([&](const nlohmann::json& state) { return state[key] == value; });
    }
};

TEST_F(Buttons, ToolbarButtonsWork) {
    const auto window = open();
    window->click_on("Volumes");
    EXPECT_TRUE(window->reaches([](const nlohmann::json& state) { return state["level"] != -1 && state["volumes"] > 0; }));
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
