// "Copy command line": the copied command renders exactly the window's picture.
#include <gtest/gtest.h>

#include <iterator>

#include "support/read_exr.hpp"
#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

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
