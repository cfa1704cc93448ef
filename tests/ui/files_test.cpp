// Files opened, dropped, broken, empty: a file that cannot be read causes a message and never ends the program.
#include <gtest/gtest.h>

#include <filesystem>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

namespace fs = std::filesystem;

class Files : public WindowTest {
 protected:
    // Drops files through the callback that the window system calls.
    static void drop(WindowDriver& window, const std::vector<std::string>& files) {
        ASSERT_EQ(window.command("drop " + nlohmann::json(files).dump()), "");
        window.settle();
    }
};

TEST_F(Files, ABrokenFileGivesAMessageAndKeepsTheOldScene) {
    const auto window = open();
    const TemporaryFolder folder;
    const Pixels before = window->picture();
    const auto was = window->state();
    std::ofstream(folder.path() + "/broken.fbx") << "Kaydara FBX Binary  \x00 and nothing more";
    std::ofstream(folder.path() + "/broken.scene") << "sphere center 0 0\n";
    int messages = 0;
    for (const std::string name : {"broken.fbx", "broken.scene", "missing.obj", "."}) {
        SCOPED_TRACE(name);
        ASSERT_EQ(window->command("open " + folder.path() + "/" + name), "");
        window->settle();
        const auto now = window->state();
        EXPECT_EQ(now["messages"], ++messages);
        EXPECT_NE(std::string(now["message"]).find(name), std::string::npos) << now["message"];
        EXPECT_EQ(now["files"], was["files"]);
        EXPECT_FALSE(now["behind"]);
        EXPECT_EQ(difference(before, window->picture(), 0), 0);
        EXPECT_NE(window->errors().find(name), std::string::npos);
    }
    window->key("Left");
    window->settle();
    EXPECT_GT(difference(before, window->picture()), 0.01);
    // Afterwards a good file opens, and the message is gone.
    ASSERT_EQ(window->command("open " + source_path("scenes/cornell.scene")), "");
    window->settle();
    EXPECT_EQ(window->state()["message"], "");
    EXPECT_EQ(window->state()["files"][0], source_path("scenes/cornell.scene"));
    window->quit();
    EXPECT_EQ(window->exit_code(), 0);
}

TEST_F(Files, OpensWithoutASceneAndLoadsOneLater) {
    WindowDriver window({});
    window.settle();
    EXPECT_EQ(window.state()["message"], "");
    window.key("Left");
    window.key("1");
    window.key("f");
    EXPECT_NE(window.line("fps 0.0", 5), "");
    ASSERT_EQ(window.command("open " + source_path("scenes/cornell.scene")), "");
    window.settle();
    EXPECT_EQ(window.state()["files"][0], source_path("scenes/cornell.scene"));
    EXPECT_GT(window.state()["primary"], 0);
}

TEST_F(Files, DroppedFilesAreOpenedAsOneScene) {
    const auto window = open();
    const TemporaryFolder folder;
    const std::string one = folder.path() + "/one square.obj", two = folder.path() + "/two.obj";
    std::ofstream(one) << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    std::ofstream(two) << "v 2 0 0\nv 3 0 0\nv 3 1 0\nf 1 2 3\n";
    drop(*window, {one});
    EXPECT_EQ(window->state()["files"], nlohmann::json({one}));
    EXPECT_EQ(window->state()["triangles"], 2);
    EXPECT_EQ(window->state()["message"], "");
    drop(*window, {one, two});
    EXPECT_EQ(window->state()["files"], nlohmann::json({one, two}));
    EXPECT_EQ(window->state()["triangles"], 3);
    // If one of several files is bad, none of them is opened.
    const Pixels before = window->picture();
    drop(*window, {two, folder.path() + "/missing.obj"});
    EXPECT_NE(std::string(window->state()["message"]).find("missing.obj"), std::string::npos);
    EXPECT_EQ(window->state()["files"], nlohmann::json({one, two}));
    EXPECT_EQ(difference(before, window->picture(), 0), 0);
    // Drop onto a window without a scene.
    WindowDriver empty({});
    empty.settle();
    drop(empty, {source_path("scenes/cornell.scene")});
    EXPECT_EQ(empty.state()["files"][0], source_path("scenes/cornell.scene"));
}

// Scenes without camera, lights or shapes: they open, keys and clicks do no harm, and the next scene opens too.
TEST_F(Files, ScenesThatLackSomething) {
    const TemporaryFolder folder;
    const std::pair<const char*, const char*> scenes[] = {
        {"empty", ""},
        {"nothing but a comment", "# nothing\n"},
        {"no camera, no light", "sphere center 0 0 0 radius 1\n"},
        {"a plane", "plane normal 0 1 0 offset 0\n"},
        {"a camera that looks away", "camera main eye 0 0 5 target 0 0 9 fov 40\nsphere center 0 0 0 radius 1\n"},
        {"lights only", "light point position 0 1 0 color 1 1 1 intensity 1\n"}};
    const auto window = open();
    for (const auto& [name, text] : scenes) {
        SCOPED_TRACE(name);
        const std::string path = folder.path() + "/" + name + ".scene";
        std::ofstream(path) << text;
        const auto was = window->state();
        ASSERT_EQ(window->command("open " + path), "");
        window->settle();
        const auto now = window->state();
        // The scene is shown, or a message says why it is not.
        EXPECT_TRUE(now["files"] == nlohmann::json({path}) || now["messages"] > was["messages"]) << now["message"];
        EXPECT_FALSE(now["behind"]);
        for (const char* key : {"Left", "w", "1", "0", "0", "g", "l", "l", "n", "c", "x", "c", "Home"}) window->key(key);
        window->click(window->place_of_pixel(160, 120));
        window->click(window->place_of_pixel(150, 120), Button::right);
        window->double_click(window->place_of_pixel(10, 10));
        window->settle();
        EXPECT_TRUE(window->running());
        for (const char* change :
             {"edit light.0 off", "edit hide 0", "edit material.0.color 1,0,0", "set aov prim", "set aov color"})
            window->command(change);  // may be refused
        window->settle();
        EXPECT_FALSE(window->state()["comparing"]);
    }
    ASSERT_EQ(window->command("open " + source_path("scenes/cornell.scene")), "");
    window->settle();
    EXPECT_EQ(window->state()["files"][0], source_path("scenes/cornell.scene"));
    EXPECT_GT(int(window->state()["primary"]), 0);
    window->quit();
    EXPECT_EQ(window->exit_code(), 0);
}

TEST_F(Files, AFailedWriteGivesAMessage) {
    const auto window = open();
    EXPECT_NE(window->command("save /no/such/folder/a.png").find("/no/such/folder"), std::string::npos);
    EXPECT_NE(window->command("save a.jpeg"), "");
    const auto was = window->state();
    fs::permissions(window->folder() + "/started_in", fs::perms::owner_read | fs::perms::owner_exec);
    window->key("ctrl+s");  // root can write there
    window->settle();
    fs::permissions(window->folder() + "/started_in", fs::perms::owner_all);
    EXPECT_TRUE(window->state()["messages"] > was["messages"] || fs::exists(window->folder() + "/started_in/clarity_0001.png"));
    EXPECT_TRUE(window->running());
}

}  // namespace
}  // namespace clarity::ui
