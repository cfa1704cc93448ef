// Objects that are moved and hidden in the window: handles, undo, what a step costs, saving the scene, and files that are saved
// in an editor while the window shows them.
#include <gtest/gtest.h>

#include <cmath>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

const char* const kScene =
    "camera main eye 0 0 5 target 0 0 0 fov 40\n"
    "background .2 .3 .4\nambient .5\n"
    "light point position 0 2 4 color .3 .3 .3\n"
    "material red color .8 .1 .1 specular 0\n"
    "material green color .1 .8 .1 specular 0\n"
    "load square.obj translate -1 0 0 material red\n"
    "load other.obj translate 1 0 0 material green\n"
    "sphere center 0 1.3 0 radius .3\n";

class Edits : public WindowTest {
 protected:
    void SetUp() override {
        WindowTest::SetUp();
        if (IsSkipped()) return;
        for (const char* name : {"/square.obj", "/other.obj"})
            std::ofstream(folder.path() + name) << "v -.8 -.8 0\nv .8 -.8 0\nv .8 .8 0\nv -.8 .8 0\nf 1 2 3 4\n";
        scene = folder.path() + "/squares.scene";
        write(kScene);
        window = open_scene(scene, "160x120");
    }
    void write(const std::string& text) const { std::ofstream(scene) << text; }
    void expect_as_command() {
        const std::string path = folder.path() + "/command.png", line = command_line(*window, path);
        ASSERT_EQ(run_command_line(line), 0) << line;
        EXPECT_LE(difference(window->picture(), read_png(path), 1), 0) << line;
    }
    TemporaryFolder folder;
    std::string scene;
    std::unique_ptr<WindowDriver> window;
};

TEST_F(Edits, AHandleMovesTheSelectedObject) {
    const Pixels before = window->picture();
    ASSERT_EQ(window->command("pick 50 60"), "");
    window->settle();
    ASSERT_EQ(window->state()["selected"]["instance"], 0);
    window->key("m");
    window->settle();
    EXPECT_TRUE(window->state()["move_handles"]);
    EXPECT_EQ(difference(window->picture(), before, 1), 0) << "an object that is about to move looks the same";

    const Place from = window->place_of("move x");
    window->drag(from, {from.x + 60, from.y + 5});
    window->settle();
    auto now = window->state();
    ASSERT_EQ(now["moved"].size(), 1u);
    const double by = now["moved"][0]["translate"][0];
    EXPECT_GT(by, 0.1);
    EXPECT_EQ(now["moved"][0]["translate"][1], 0);
    EXPECT_TRUE(now["update"]["refitted"]) << now["update"].dump();
    EXPECT_GT(difference(window->picture(), before, 8), 0.02);
    EXPECT_EQ(now["undo"], "Place of objects");
    expect_as_command();

    // Turning and scaling go on top of that.
    const Place ring = window->place_of("turn z");
    window->drag(ring, {ring.x + 25, ring.y + 25});
    const Place square = window->place_of("scale");
    window->drag(square, {square.x + 20, square.y - 20});
    window->settle();
    now = window->state();
    EXPECT_NEAR(now["moved"][0]["translate"][0], by, 1e-6);
    EXPECT_GT(std::abs(double(now["moved"][0]["rotate"][2])), 1);
    EXPECT_GT(now["moved"][0]["scale"][1], 1.05);
    EXPECT_TRUE(now["update"]["refitted"]) << now["update"].dump();
    expect_as_command();

    // Each drag is one step.
    for (int i = 0; i < 3; ++i) window->key("ctrl+z");
    window->settle();
    EXPECT_TRUE(window->state()["moved"].empty());
    EXPECT_TRUE(window->state()["update"]["refitted"]) << window->state()["update"].dump();
    EXPECT_EQ(difference(window->picture(), before, 1), 0);
    window->key("ctrl+y");
    window->settle();
    EXPECT_NEAR(window->state()["moved"][0]["translate"][0], by, 1e-6);
}

// Kernels are compiled for the lights and surfaces that a scene has. Others, which an edit brings, are compiled then.
TEST_F(Edits, NewKindsOfLightsAndSurfacesAreShown) {
    ASSERT_EQ(window->command("tab Render"), "");  // with the rows of path, among them that of the seed
    ASSERT_EQ(window->command("set tracer path"), "");
    ASSERT_EQ(window->command("set spp 4"), "");
    window->settle();
    Pixels last = window->picture();
    for (const char* edit : {"material.1.model conductor", "light.0 rect,0,3,4,1,0,0,0,0,1,9,9,9", "background 0,0,0",
                             "material.2.emission 2,1,0"}) {
        ASSERT_EQ(window->command("edit " + std::string(edit)), "");
        window->settle();
        EXPECT_EQ(window->state()["message"], "");
        EXPECT_GT(difference(window->picture(), last, 1), 0.02) << edit;
        last = window->picture();
    }
    expect_as_command();
    window->key("ctrl+z");
    window->settle();
    EXPECT_GT(difference(window->picture(), last, 1), 0.02);
}

TEST_F(Edits, HiddenObjectsComeBackByARefit) {
    const Pixels before = window->picture();
    ASSERT_EQ(window->command("edit hide 1"), "");
    window->settle();
    const Pixels hidden = window->picture();
    EXPECT_GT(difference(hidden, before, 8), 0.05);
    expect_as_command();
    ASSERT_EQ(window->command("edit hide "), "");
    window->settle();
    EXPECT_TRUE(window->state()["update"]["refitted"]) << window->state()["update"].dump();
    EXPECT_EQ(difference(window->picture(), before, 1), 0);
    ASSERT_EQ(window->command("edit hide 1"), "");
    window->settle();
    EXPECT_TRUE(window->state()["update"]["refitted"]) << window->state()["update"].dump();
    EXPECT_EQ(difference(window->picture(), hidden, 1), 0);
}

TEST_F(Edits, ASavedSceneShowsTheSame) {
    ASSERT_EQ(window->command("edit instance.0.translate 0.25,0.5,0"), "");
    ASSERT_EQ(window->command("edit instance.0.rotate 0,0,30"), "");
    ASSERT_EQ(window->command("edit material.2.color 0.1,0.2,0.9"), "");
    ASSERT_EQ(window->command("edit camera 0.3,0.2,5,0,0,0,45,0,1,0"), "");
    window->settle();
    const std::string saved = folder.path() + "/saved.scene";
    ASSERT_EQ(window->command("save_scene " + saved), "");
    const Pixels wanted = window->picture();
    const auto again = open_scene(saved, "160x120");
    EXPECT_EQ(difference(again->picture(), wanted, 1), 0);
    EXPECT_EQ(again->state()["moved"].size(), 1u) << "edits of a file can be changed again";
    again->key("ctrl+e");
    again->settle();
    EXPECT_EQ(again->state()["message"], "");
    EXPECT_NE(window->command("save_scene " + folder.path() + "/saved.txt"), "");
}

TEST_F(Edits, ASavedFileIsReadAgain) {
    ASSERT_EQ(window->command("edit instance.0.translate 0,0.25,0"), "");
    ASSERT_EQ(window->command("edit camera 0,0.1,5,0,0,0,40,0,1,0"), "");
    window->settle();
    const Pixels before = window->picture();
    const auto changes = [&](const Pixels& from) {
        return window->reaches([&](const nlohmann::json& state) {
            return !state["busy"] && !state["behind"] && difference(window->picture(), from, 8) > 0.02;
        });
    };
    std::string text = kScene;
    text.replace(text.find(".1 .8 .1"), 8, ".1 .1 .9");
    write(text);
    ASSERT_TRUE(changes(before)) << window->errors();
    window->settle();
    auto now = window->state();
    EXPECT_NEAR(now["eye"][1], 0.1, 1e-6) << "the view stays";
    ASSERT_EQ(now["moved"].size(), 1u) << "so do the edits";
    EXPECT_EQ(now["moved"][0]["translate"][1], 0.25);
    expect_as_command();

    // A file that cannot be read leaves the scene, and says why.
    const Pixels blue = window->picture();
    write("sphere center 0 0\n");
    ASSERT_TRUE(window->reaches([](const nlohmann::json& state) { return state["message"] != ""; }));
    EXPECT_NE(std::string(window->state()["message"]).find("squares.scene:1"), std::string::npos);
    window->settle();
    EXPECT_EQ(difference(window->picture(), blue, 0), 0);

    // A file that it loads counts, too.
    write(text);
    ASSERT_TRUE(window->reaches([](const nlohmann::json& state) { return state["message"] == ""; }));
    window->settle();
    std::ofstream(folder.path() + "/other.obj") << "v -.3 -.3 0\nv .3 -.3 0\nv .3 .3 0\nv -.3 .3 0\nf 1 2 3 4\n";
    ASSERT_TRUE(changes(blue)) << window->errors();
}

// The sky of `path`: each change gives the picture of the command line, is one step, and is saved.
TEST_F(Edits, TheSkyIsEditedUndoneAndSaved) {
    for (const char* command : {"set tracer path", "set spp 4", "edit light.0 off"}) ASSERT_EQ(window->command(command), "");
    window->settle();
    const Pixels before = window->picture();
    for (const char* command :
         {"edit sky gradient", "edit sky.zenith 0,0,4", "edit sky.horizon 1,0.5,0", "edit sky.visible false"}) {
        SCOPED_TRACE(command);
        const Pixels last = window->picture();
        ASSERT_EQ(window->command(command), "");
        window->settle();
        EXPECT_EQ(window->state()["undo"], "Sky");
        EXPECT_GT(difference(window->picture(), last, 8), 0.02);
    }
    expect_as_command();
    const Pixels edited = window->picture();
    const std::string saved = folder.path() + "/saved.scene";
    ASSERT_EQ(window->command("save_scene " + saved), "");
    for (int i = 0; i < 4; ++i) window->key("ctrl+z");
    window->settle();
    EXPECT_EQ(difference(window->picture(), before, 1), 0);
    ASSERT_EQ(window->command("open " + saved), "");
    window->settle();
    EXPECT_LE(difference(window->picture(), edited, 1), 0);
}

}  // namespace
}  // namespace clarity::ui
