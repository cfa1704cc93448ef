// Undo and redo by keys.
#include <gtest/gtest.h>

#include <iterator>

#include "support/read_exr.hpp"
#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

class Undo : public WindowTest {
 protected:
    static int steps(WindowDriver& window) {
        int count = 0;
        while (window.state()["undo"] != "" && count < 50) {
            window.key("ctrl+z");
            window.settle();
            ++count;
        }
        return count;
    }
};

TEST_F(Undo, EveryKindOfChangeCanBeUndoneAndRedone) {
    const auto window = open();
    std::vector<std::string> desired_states = {desired(*window)};
    std::vector<Pixels> pictures = {window->picture()};
    const char* const changes[] = {"set depth 2",
                                   "edit light.0 point,3,6,5,1,.2,.2",
                                   "edit light.1 off",
                                   "edit background .8,.2,.1",
                                   "edit material.1.color .1,.9,.1",
                                   "edit hide 0",
                                   "set tone reinhard",
                                   "accel spheres,max_leaf=8"};
    for (const char* change : changes) {
        ASSERT_EQ(window->command(change), "");
        window->settle();
        desired_states.push_back(desired(*window));
        pictures.push_back(window->picture());
        EXPECT_NE(desired_states.back(), desired_states[desired_states.size() - 2]) << change;
    }
    // Undo leaves the camera where the keys have moved it.
    const auto eye = window->state()["eye"];
    for (size_t i = desired_states.size() - 1; i-- > 0;) {
        SCOPED_TRACE(changes[i]);
        EXPECT_NE(window->state()["undo"], "");
        window->key("ctrl+z");
        window->settle();
        EXPECT_EQ(desired(*window), desired_states[i]);
        EXPECT_EQ(difference(window->picture(), pictures[i], 0), 0);
    }
    EXPECT_EQ(window->state()["undo"], "");
    window->key("ctrl+z");  // nothing left to undo: nothing happens
    window->settle();
    EXPECT_EQ(desired(*window), desired_states.front());
    for (size_t i = 1; i < desired_states.size(); ++i) {
        SCOPED_TRACE(changes[i - 1]);
        window->key("ctrl+y");
        window->settle();
        EXPECT_EQ(desired(*window), desired_states[i]);
    }
    EXPECT_EQ(difference(window->picture(), pictures.back(), 0), 0);
    EXPECT_EQ(window->state()["redo"], "");
    EXPECT_EQ(window->state()["eye"], eye);
    // A new change after an undo discards the steps to redo.
    window->key("ctrl+z");
    ASSERT_EQ(window->command("set depth 3"), "");
    window->settle();
    EXPECT_EQ(window->state()["redo"], "");
    EXPECT_EQ(window->state()["undo"], "Depth");
}

TEST_F(Undo, ADraggedSliderIsOneStep) {
    const auto window = open();
    const std::string before = desired(*window);
    window->drag(window->place_of("Depth", 0.9), window->place_of("Depth", 0.1));
    window->settle();
    EXPECT_LT(int(window->state()["depth"]), 4);
    EXPECT_EQ(window->state()["undo"], "Depth");
    EXPECT_EQ(steps(*window), 1);
    EXPECT_EQ(desired(*window), before);
}

TEST_F(Undo, AHeldKeyIsOneStep) {
    const auto window = open();
    const std::string before = desired(*window);
    const auto light = window->state()["light"];
    window->key_down("d");
    int moves = 0;  // times that the light was seen to move; several of them are one step
    for (nlohmann::json last = light; moves < 3;) {
        ASSERT_TRUE(window->reaches([&](const nlohmann::json& state) { return state["light"] != last; }));
        last = window->state()["light"];
        ++moves;
    }
    window->key_up("d");
    window->settle();
    EXPECT_EQ(steps(*window), 1);
    EXPECT_EQ(desired(*window), before);
}

TEST_F(Undo, AnotherSceneHasItsOwnHistory) {
    const auto window = open();
    ASSERT_EQ(window->command("set depth 2"), "");
    window->settle();
    ASSERT_EQ(window->state()["undo"], "Depth");
    ASSERT_EQ(window->command("open " + source_path("scenes/cornell.scene")), "");
    window->settle();
    EXPECT_EQ(window->state()["undo"], "");
    window->key("ctrl+z");
    window->settle();
    EXPECT_EQ(window->state()["files"][0], source_path("scenes/cornell.scene"));
    EXPECT_EQ(window->state()["depth"], 2);
}

// // Presets: all that determines a picture is written and read again; a wrong preset changes nothing.

class Presets : public WindowTest {};

TEST_F(Presets, RestoreThePictureBitByBit) {
    const auto window = open();
    const TemporaryFolder folder;
    const std::string path = folder.path() + "/my preset.json";
    for (const char* change : {"edit light.0 point,3,6,5,1,.4,.2", "edit light.1 off", "edit material.1.color .1,.9,.1",
                               "edit hide 1", "set tone aces", "set exposure 1.3", "set spp 2", "edit ambient .3,.2,.1"})
        ASSERT_EQ(window->command(change), "") << change;
    window->key("Left");
    window->key("i");
    window->settle();
    const std::string saved = desired(*window);
    const Pixels picture = window->picture();
    ASSERT_EQ(window->command("save_preset " + path), "");

    for (const char* change :
         {"edit light.0 point,-3,2,1,.2,.4,1", "edit light.1 directional,0,1,0,1,1,1", "edit material.1.color .9,.1,.1",
          "edit material.3.reflect .1", "edit hide 0,2", "set tone linear", "set exposure .5", "set spp 1", "set depth 2",
          "edit background 1,0,0", "set size 160x120"})
        ASSERT_EQ(window->command(change), "") << change;
    window->key("Up");
    window->settle();
    EXPECT_NE(desired(*window), saved);
    EXPECT_GT(difference(picture, window->picture()), 0.1);

    ASSERT_EQ(window->command("load_preset " + path), "");
    window->settle();
    EXPECT_EQ(desired(*window), saved);
    EXPECT_EQ(difference(picture, window->picture(), 0), 0);
    // Loading a preset is one step of undo.
    window->key("ctrl+z");
    window->settle();
    EXPECT_EQ(window->state()["size"], "160x120");

    // The preset also works in another window on the same scene.
    const auto other = open();
    ASSERT_EQ(other->command("load_preset " + path), "");
    other->settle();
    EXPECT_EQ(difference(picture, other->picture(), 0), 0);
}

TEST_F(Presets, AnInvalidPresetChangesNothing) {
    const auto window = open();
    const TemporaryFolder folder;
    ASSERT_EQ(window->command("edit light.1 off"), "");
    ASSERT_EQ(window->command("set exposure 1.5"), "");
    window->settle();
    const std::string before = desired(*window);
    const std::string start = R"({"clarity_preset": 1, "settings": {"depth": "2", "tone": "aces"})";
    const std::vector<std::pair<std::string, std::string>> wrong = {
        {"", "preset"},
        {"{ \"clarity_preset\": 1,", "parse"},
        {"[1, 2]", "clarity_preset"},
        {R"({"clarity_preset": 99})", "version"},
        {start + R"(, "colour": 1})", "colour"},
        {start + R"(, "accel": {"id": "no_such_tree"}})", "no_such_tree"},
        {start + R"(, "accel": {"id": "bvh2", "max_leaf": "-3"}})", "max_leaf"},
        {start + R"(, "edits": [["exposure", "1"]]})", "edit"},
        {start + R"(, "edits": [["background", "1,0,0"], ["material.99.color", "1,0,0"]]})", "material.99"},
        {start + R"(, "edits": [["light.0", "off"], ["hide", "77"]]})", "hide"},
        {R"({"clarity_preset": 1, "settings": {"depth": "999"}})", "depth"},
    };
    for (size_t i = 0; i < wrong.size(); ++i) {
        SCOPED_TRACE(wrong[i].first);
        const std::string path = folder.path() + "/wrong" + std::to_string(i) + ".json";
        std::ofstream(path) << wrong[i].first;
        const std::string error = window->command("load_preset " + path);
        EXPECT_NE(error.find(path), std::string::npos) << error;
        EXPECT_NE(error.find(wrong[i].second), std::string::npos) << error;
        EXPECT_EQ(desired(*window), before);
    }
    EXPECT_NE(window->command("load_preset " + folder.path() + "/missing.json").find("missing.json"), std::string::npos);
    EXPECT_NE(window->command("save_preset " + folder.path() + "/no/such/folder.json"), "");
    window->settle();
    EXPECT_EQ(desired(*window), before);
    EXPECT_FALSE(window->state()["behind"]);
}

// // "Copy command line": the copied command renders exactly the window's picture.

std::string bytes_of(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

// A picture's pixels in words. Files differ in what else they say: a window's picture names another command.
std::string pixels_of(const std::string& path, const std::string& ending) {
#ifdef CLARITY_HAVE_OPENEXR
    if (ending == "exr") {
        const FloatPixels values = read_exr(path, {"R", "G", "B"}).pixels;
        return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
    }
#endif
    if (ending != "png") return bytes_of(path);
    const Pixels pixels = read_png(path);
    return std::to_string(pixels.width) + "x" + std::to_string(pixels.height) +
           std::string(pixels.rgb.begin(), pixels.rgb.end());
}

class CommandLine : public WindowTest {
 protected:
    // Saves the window's picture, runs the window's command line, and expects equal pixels. The saved file names the command.
    void expect_same(WindowDriver& window, const std::string& ending) {
        const std::string saved = folder.path() + "/of the window." + ending, rendered = folder.path() + "/it's one." + ending;
        save(window, saved);
        const std::string line = command_line(window, rendered);
        SCOPED_TRACE(line);
        ASSERT_EQ(run_command_line(line), 0);
        ASSERT_FALSE(bytes_of(rendered).empty());
        EXPECT_TRUE(pixels_of(saved, ending) == pixels_of(rendered, ending)) << "they differ";
        if (ending != "pfm") {
            EXPECT_NE(bytes_of(saved).find(command_line(window, saved)), std::string::npos) << "no command in it";
        }
        if (ending == "png") {
            EXPECT_EQ(difference(read_png(rendered), window.picture(), 0), 0);
        }
        std::remove(saved.c_str());
        std::remove(rendered.c_str());
    }
    TemporaryFolder folder;
};

TEST_F(CommandLine, RendersTheWindowsPictureBitByBit) {
    const auto window = open();
    // First as the scene opens, then with the camera moved by keys and mouse.
    expect_same(*window, "png");
    window->key_down("Right");
    usleep(200000);
    window->key_up("Right");
    window->key("i");
    window->key("Prior");
    window->settle();
    window->drag(window->place_of_pixel(100, 100), window->place_of_pixel(160, 90));
    window->wheel(window->place_of_pixel(100, 100), 2);
    window->settle();
    expect_same(*window, "png");
    // Then with lights, materials, surroundings, hidden instances and settings changed.
    window->key("a");
    for (const char* change :
         {"edit light.1 off", "edit light.2 point,1,5,3,.3,.1,.05", "edit material.1.color .123456,.9,.1",
          "edit material.3.ior 1.7", "edit material.4.emission .2,.1,0", "edit background .1,.2,.3", "edit ambient .05,.06,.07",
          "edit hide 0-1", "set tone agx", "set exposure 1.234567", "set spp 3", "set depth 3", "set min_weight .02"})
        ASSERT_EQ(window->command(change), "") << change;
    window->settle();
    expect_same(*window, "png");
    for (const char* ending : {"pfm", "exr"}) expect_same(*window, ending);
}

TEST_F(CommandLine, NamesStructureAndSize) {
    const auto window = open();
    ASSERT_EQ(window->command("accel spheres,max_leaf=8"), "");
    ASSERT_EQ(window->command("set size 131x77"), "");
    ASSERT_EQ(window->command("set aov steps"), "");
    window->settle();
    const std::string line = command_line(*window, "x.png");
    EXPECT_NE(line.find("spheres,max_leaf=8"), std::string::npos) << line;
    expect_same(*window, "png");
    expect_same(*window, "pfm");
}

// File names with characters that are special to a shell.
TEST_F(CommandLine, QuotesWordsForTheShell) {
    const std::string scene = folder.path() + "/it's $HOME; a scene.scene";
    std::ofstream(scene) << "camera main eye 0 0 5 target 0 0 0 fov 40\nsphere center 0 0 0 radius 1\n"
                            "light point position 2 4 5 color 1 1 1 intensity 1\n";
    const auto window = open_scene(scene, "96x72");
    EXPECT_EQ(window->state()["message"], "");
    expect_same(*window, "png");
}

}  // namespace
}  // namespace clarity::ui
