// Start and end of the window, what it remembers, and that the newest of many requests counts.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

namespace fs = std::filesystem;

class Window : public WindowTest {};

TEST_F(Window, ManyChangesAtOnceShowTheLastOne) {
    const auto window = open();
    for (int round = 0; round < 10; ++round)
        for (const char* change :
             {"accel spheres", "set lanes 4", "set depth 2", "accel bvh2", "set lanes auto", "set depth 4"})
            window->send(change);
    window->settle();
    const auto now = window->state();
    EXPECT_EQ(now["accel"], "bvh2");
    EXPECT_EQ(now["depth"], 4);
    EXPECT_EQ(now["message"], "");
    EXPECT_FALSE(now["behind"]);
}

// A PoCL device is closed and reopened after 16 programs. Meanwhile the Stats tab still shows what was on it.
TEST_F(Window, StatisticsStayWhileDevicesAreReopened) {
    const auto window = open_scene(source_path("scenes/cornell.scene"), "64x48");
    ASSERT_EQ(window->command("tab Stats"), "");
    for (const char* change : {"accel linear", "set aov t", "set lanes 1"}) ASSERT_EQ(window->command(change), "");
    for (const char* aov : {"t", "prim", "normal"})
        for (const char* packet : {"1x1", "2x1", "1x2", "2x2", "4x1", "1x4", "4x2", "2x4", "4x4", "8x1"}) {
            ASSERT_EQ(window->command(std::string("set aov ") + aov), "");
            ASSERT_EQ(window->command(std::string("set packet ") + packet), "");
            window->settle();
            const auto now = window->state();
            ASSERT_EQ(now["packet"], packet) << now["message"];
            ASSERT_EQ(now["aov"], aov);
        }
    EXPECT_EQ(window->state()["message"], "");
    window->quit();
    EXPECT_EQ(window->exit_code(), 0);
}

// Samples accumulate while nothing changes. The result is the picture that the command line makes.
TEST_F(Window, SamplesAccumulateAtRest) {
    const TemporaryFolder folder;
    const auto window = open();
    EXPECT_EQ(window->state()["samples"], 16);
    const std::string line = command_line(*window, folder.path() + "/again.png");
    EXPECT_NE(line.find("spp"), std::string::npos) << line;
    ASSERT_EQ(run_command_line(line), 0);
    EXPECT_EQ(difference(window->picture(), read_png(folder.path() + "/again.png"), 0), 0);
    // For AOVs other than colour, only the last sample would remain. So there is one sample.
    const Pixels colors = window->picture();
    ASSERT_EQ(window->command("set aov prim"), "");
    window->settle();
    EXPECT_EQ(window->state()["samples"], 1);
    ASSERT_EQ(run_command_line(command_line(*window, folder.path() + "/prim.png")), 0);
    EXPECT_EQ(difference(window->picture(), read_png(folder.path() + "/prim.png"), 0), 0);
    ASSERT_EQ(window->command("set aov color"), "");
    window->settle();
    EXPECT_EQ(window->state()["samples"], 16);
    EXPECT_EQ(difference(window->picture(), colors, 0), 0);
    // A number of samples that the user asked for is kept.
    WindowDriver single({"--size", "320x240", "--spp", "1", source_path("scenes/primitives.scene")});
    single.settle();
    EXPECT_EQ(single.state()["samples"], 1);
    EXPECT_GT(difference(window->picture(), single.picture(), 0), 0.01);
}

TEST_F(Window, ShowsAnImportWarningOnce) {
    const TemporaryFolder folder;
    std::ofstream(folder.path() + "/a.obj") << "mtllib missing.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const auto window = open_scene(folder.path() + "/a.obj", "64x48");
    const std::string errors = window->errors();
    const size_t first = errors.find("missing.mtl");
    ASSERT_NE(first, std::string::npos) << errors;
    EXPECT_EQ(errors.find("missing.mtl", errors.find('\n', first)), std::string::npos) << errors;
}

TEST_F(Window, WithoutADisplayExplainsHowToRender) {
    WindowDriver window({source_path("scenes/primitives.scene")}, {{"DISPLAY", ""}});
    EXPECT_TRUE(comes([&] { return !window.running(); }));
    EXPECT_EQ(window.exit_code(), 2);
    EXPECT_NE(window.errors().find("clarity render"), std::string::npos) << window.errors();
    // DISPLAY names a display that does not exist.
    WindowDriver gone({source_path("scenes/primitives.scene")}, {{"DISPLAY", ":4711"}});
    EXPECT_TRUE(comes([&] { return !gone.running(); }));
    EXPECT_EQ(gone.exit_code(), 2);
    EXPECT_NE(gone.errors().find("clarity render"), std::string::npos) << gone.errors();
}

TEST_F(Window, WritesPreferencesToTheConfigurationFolderOnly) {
    const TemporaryFolder config;
    {
        const auto window = open({{"CLARITY_UI_NO_SAVE", ""}, {"XDG_CONFIG_HOME", config.path()}});
        ASSERT_EQ(window->command("map viewer"), "");
        window->quit();
        EXPECT_EQ(window->exit_code(), 0);
        EXPECT_TRUE(fs::is_empty(window->folder() + "/started_in"));
        EXPECT_TRUE(fs::exists(config.path() + "/clarity/window.json"));
    }
    {
        const auto window = open({{"CLARITY_UI_NO_SAVE", ""}, {"XDG_CONFIG_HOME", config.path()}});
        EXPECT_EQ(window->state()["map"], "viewer");
    }
    const TemporaryFolder untouched;
    const auto window = open({{"XDG_CONFIG_HOME", untouched.path()}});
    window->quit();
    EXPECT_TRUE(fs::is_empty(untouched.path()));
}

// A library that was built again is loaded from a copy in a temporary folder.
TEST_F(Window, ASignalClosesItAndLeavesNoCopiesOfLibrariesBehind) {
    const TemporaryFolder temporary, own;
    const fs::path installed = fs::path(program_path()).parent_path().parent_path() / "lib/clarity/plugins/accel/linear.so";
    const fs::path library = fs::path(own.path()) / "linear.so", built = fs::path(own.path()) / "linear.so.new";
    ASSERT_TRUE(fs::copy_file(installed, library));
    WindowDriver window({"--size", "320x240", "--plugin", library.string(), source_path("scenes/primitives.scene")},
                        {{"TMPDIR", temporary.path()}});
    window.settle();
    const auto copies = [&] {
        return std::count_if(fs::directory_iterator(temporary.path()), fs::directory_iterator(), [](const auto& entry) {
            return entry.path().filename().string().rfind("clarity-plugins-", 0) == 0;
        });
    };
    fs::copy_file(installed, built);
    std::ofstream(built, std::ios::app) << ' ';  // the same content would be left alone
    fs::rename(built, library);
    ASSERT_TRUE(comes([&] { return copies() == 1; }));
    window.settle();
    window.quit_by(SIGTERM);
    EXPECT_EQ(window.exit_code(), 130) << window.errors();
    // After a signal another process removes the folders, when this one has ended.
    EXPECT_TRUE(comes([&] { return copies() == 0; }));
}

// // Files opened, dropped, broken, empty: a file that cannot be read causes a message and never ends the program.

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
