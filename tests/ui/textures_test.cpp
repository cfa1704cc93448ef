// Textures of materials in the window: their rows, pictures of files, undo, saved scenes and command lines.
#include <gtest/gtest.h>

#include <fstream>

#include "ui/driver/faulty_driver.hpp"
#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

// Material 1 has a texture, material 2 has none. In the picture the first one is at the left.
const char* const kSquares =
    "camera main eye 0 0 5 target 0 0 0 fov 40\n"
    "background .2 .3 .4\nambient .5\n"
    "light directional direction 0 0 -1 color .5\n"
    "texture  stripes  \"stripes.ppm\" filter nearest\n"
    "material paper model lambert color_map stripes\n"
    "material plain model lambert color 1\n"
    "load square.obj translate -1 0 0 material paper\n"
    "load square.obj translate 1 0 0 material plain\n";

class Textures : public WindowTest {
 protected:
    void SetUp() override {
        WindowTest::SetUp();
        if (IsSkipped()) return;
        write("square.obj",
              "v -.8 -.8 0\nv .8 -.8 0\nv .8 .8 0\nv -.8 .8 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n"
              "f 1/1/1 2/2/1 3/3/1 4/4/1\n");
        write("stripes.ppm", std::string("P6 2 1 255\n") + "\xff\x20\x20\x20\x20\xff");
        write("green.ppm", std::string("P6 1 1 255\n") + "\x20\xff\x20");
        // Normals that lean to the right.
        write("lean.ppm", std::string("P6 1 1 255\n") + "\xd0\x80\xd0");
        write("squares.scene", kSquares);
        window = open_scene(path("squares.scene"), "160x120");
    }
    std::string path(const std::string& name) const { return folder.path() + "/" + name; }
    void write(const std::string& name, const std::string& bytes) const {
        std::ofstream(path(name), std::ios::binary) << bytes;
    }
    // Red, green and blue in the middle of a half's left or right half.
    std::array<int, 3> color(int x) {
        const Pixels picture = window->picture();
        const size_t at = 3 * (size_t(picture.width) * 60 + size_t(x));
        return {picture.rgb[at], picture.rgb[at + 1], picture.rgb[at + 2]};
    }
    void expect_as_command() {
        const std::string to = path("command.png"), line = command_line(*window, to);
        ASSERT_EQ(run_command_line(line), 0) << line;
        EXPECT_LE(difference(window->picture(), read_png(to), 1), 0) << line;
    }
    TemporaryFolder folder;
    std::unique_ptr<WindowDriver> window;
    static constexpr int kPaper = 33, kPlain = 99;  // columns of the left stripe of each square
};

TEST_F(Textures, ARowChoosesAmongThePicturesOfTheScene) {
    const Pixels before = window->picture();
    ASSERT_NE(color(kPaper), color(kPlain));
    ASSERT_EQ(window->command("tab Scene"), "");
    ASSERT_EQ(window->command("pick 110 60"), "");
    window->settle();
    ASSERT_EQ(window->state()["selected"]["material"], 2);
    window->click_on("color_map");
    window->click_on("stripes");
    window->settle();
    EXPECT_EQ(color(kPaper), color(kPlain));
    EXPECT_EQ(window->state()["undo"], "Texture");
    expect_as_command();
    const Pixels with = window->picture();
    window->key("ctrl+z");
    window->settle();
    EXPECT_EQ(difference(window->picture(), before, 0), 0);
    window->key("ctrl+y");
    window->settle();
    EXPECT_EQ(difference(window->picture(), with, 0), 0);
    window->click_on("color_map");
    window->click_on("none");
    window->settle();
    EXPECT_EQ(difference(window->picture(), before, 0), 0);
    window->click_on("Reset material");
    window->settle();
    EXPECT_EQ(difference(window->picture(), before, 0), 0);
}

TEST_F(Textures, APictureOfAFileIsReadAndGiven) {
    const Pixels before = window->picture();
    ASSERT_EQ(window->command("tab Scene"), "");
    ASSERT_EQ(window->command("pick 110 60"), "");
    window->settle();
    window->click_on("color_map");
    window->click_on("a picture\u2026");
    ASSERT_TRUE(window->reaches([](const auto& state) { return state["browser_open"] && state["typing"]; }));
    window->type(path("green.ppm"));
    window->tap("Return");
    ASSERT_TRUE(window->reaches([](const auto& state) { return state["undo"] == "Texture"; }));
    window->settle();
    EXPECT_EQ(window->state()["message"], "");
    const auto green = color(kPlain);
    EXPECT_LT(green[0], green[1] / 2);
    EXPECT_LT(green[2], green[1] / 2);
    expect_as_command();
    const Pixels with = window->picture();
    window->key("ctrl+z");
    window->settle();
    EXPECT_EQ(difference(window->picture(), before, 0), 0) << "undo outlives the reading of a picture";
    window->key("ctrl+y");
    window->settle();
    EXPECT_EQ(difference(window->picture(), with, 0), 0);

    // Elsewhere, which loads the file; and in the file itself, twice, with another picture.
    for (const char* name : {"saved.scene", "squares.scene"}) {
        ASSERT_EQ(window->command("save_scene " + path(name)), "");
        const auto again = open_scene(path(name), "160x120");
        EXPECT_EQ(difference(again->picture(), with, 0), 0) << name << again->errors();
    }
    window->settle();
    EXPECT_EQ(difference(window->picture(), with, 0), 0);
    ASSERT_EQ(window->command("edit material.1.color_map " + path("green.ppm")), "");
    ASSERT_EQ(window->command("edit material.2.color_map none"), "");
    window->settle();
    EXPECT_EQ(color(kPaper), green);
    ASSERT_EQ(window->command("save_scene " + path("squares.scene")), "");
    const auto again = open_scene(path("squares.scene"), "160x120");
    EXPECT_EQ(difference(again->picture(), window->picture(), 0), 0) << again->errors();
    EXPECT_EQ(again->state()["message"], "");
}

// A use that the kernels did not know: they are compiled, and tangents are made.
TEST_F(Textures, OtherUsesAreCompiledIn) {
    const Pixels before = window->picture();
    ASSERT_EQ(window->command("tab Scene"), "");
    ASSERT_EQ(window->command("pick 110 60"), "");
    window->settle();
    const int straight = color(kPlain)[0];
    window->click_on("More textures");
    window->click_on("Normals");
    ASSERT_EQ(window->command("edit material.2.normal_map " + path("lean.ppm")), "");
    window->settle();
    EXPECT_EQ(window->state()["message"], "");
    EXPECT_LT(color(kPlain)[0], straight - 5) << "the light falls on it at an angle";
    EXPECT_EQ(difference(window->picture(), before, 8) > 0.1, true);
    window->place_of("normal_map");
    expect_as_command();
    ASSERT_NE(window->command("edit material.2.normal_map missing.png"), "");
    ASSERT_NE(window->command("edit material.2.texture_of_that green.ppm"), "");
    write("broken.png", "no picture");
    ASSERT_EQ(window->command("edit material.2.normal_map " + path("broken.png")), "");
    ASSERT_TRUE(window->reaches([](const auto& state) { return state["message"] != ""; }));
    EXPECT_NE(std::string(window->state()["message"]).find("broken.png"), std::string::npos) << window->state()["message"];
}

// // The ball of the selected material in the Scene tab.

const char* const kBalls =
    "camera main eye 0 0 5 target 0 0 0 fov 40\n"
    "background .2 .3 .4\nambient .5\n"
    "light directional direction 0 0 -1 color .5\n"
    "texture  stripes  \"stripes.ppm\"\n"
    "material matt model lambert color .8 .1 .1\n"
    "material metal model conductor color .9 .8 .6 roughness .3\n"
    "material paper model lambert color_map stripes\n"
    "sphere center -1 0 0 radius .8 material matt\n"
    "sphere center 1 0 0 radius .8 material metal\n"
    "sphere center 0 1.5 0 radius .5 material paper\n";

class PreviewOfMaterials : public FaultyDriverTest {
 protected:
    void SetUp() override {
        FaultyDriverTest::SetUp();
        std::ofstream(path("stripes.ppm"), std::ios::binary) << std::string("P6 2 1 255\n") + "\xff\x20\x20\x20\x20\xff";
        std::ofstream(path("balls.scene")) << kBalls;
    }
    std::string path(const std::string& name) const { return folder.path() + "/" + name; }
    // What compiles fast.
    std::vector<std::string> quick() const {
        return {"--size", "160x120", "--accel", "bvh2", "--lanes", "1", path("balls.scene")};
    }
    static bool is_done(const nlohmann::json& state) { return state.contains("preview") && state["preview"]["done"] == true; }
    // The finished ball of a material.
    Pixels ball(WindowDriver& window, int material) const {
        EXPECT_TRUE(
            window.reaches([&](const auto& state) { return is_done(state) && state["preview"]["material"] == material; }));
        const auto preview = window.state()["preview"];
        EXPECT_EQ(preview["failure"], "");
        const std::string file = path("ball.png");
        EXPECT_EQ(window.command("preview " + file), "");
        return read_png(file);
    }
    // The mean of a channel over the middle of the ball.
    static double mean(const Pixels& picture, int channel) {
        double sum = 0;
        int count = 0;
        for (int y = picture.height * 2 / 5; y < picture.height * 3 / 5; ++y)
            for (int x = picture.width * 2 / 5; x < picture.width * 3 / 5; ++x, ++count)
                sum += picture.rgb[3 * (size_t(y) * size_t(picture.width) + size_t(x)) + size_t(channel)];
        return sum / count;
    }
    TemporaryFolder folder;
};

TEST_F(PreviewOfMaterials, FollowsTheSelectionAndEdits) {
    const auto window = open_scene(path("balls.scene"), "160x120");
    EXPECT_FALSE(window->state().contains("preview")) << "nothing is selected";
    ASSERT_EQ(window->command("tab Scene"), "");
    ASSERT_EQ(window->command("pick 40 60"), "");
    const Pixels red = ball(*window, 1);
    EXPECT_GT(mean(red, 0), 2 * mean(red, 2));
    ASSERT_EQ(window->command("edit material.1.color .1,.1,.8"), "");
    ASSERT_TRUE(window->reaches([](const auto& state) { return !is_done(state); }));
    const Pixels blue = ball(*window, 1);
    EXPECT_GT(mean(blue, 2), 2 * mean(blue, 0));
    window->key("ctrl+z");
    ASSERT_TRUE(window->reaches([](const auto& state) { return !is_done(state); }));
    EXPECT_EQ(difference(ball(*window, 1), red, 0), 0) << "the same samples";
    ASSERT_EQ(window->command("pick 120 60"), "");
    const Pixels metal = ball(*window, 2);
    EXPECT_GT(difference(metal, red, 8), 0.1);
    // Both halves of a picture are on a ball that it goes around.
    ASSERT_EQ(window->command("edit material.2.model lambert"), "");
    ASSERT_EQ(window->command("edit material.2.color 1,1,1"), "");
    ASSERT_EQ(window->command("edit material.2.color_map stripes"), "");
    window->settle();
    const Pixels striped = ball(*window, 2);
    EXPECT_GT(difference(striped, metal, 8), 0.1);
    int reds = 0, blues = 0;
    for (size_t i = 0; i < striped.rgb.size(); i += 3) {
        reds += striped.rgb[i] > 2 * striped.rgb[i + 2] + 20;
        blues += striped.rgb[i + 2] > 2 * striped.rgb[i] + 20;
    }
    EXPECT_GT(reds, 200);
    EXPECT_GT(blues, 200);
    // It ends with its tab, and the window rests.
    ASSERT_EQ(window->command("tab Render"), "");
    ASSERT_TRUE(window->reaches([](const auto& state) { return !state.contains("preview"); }));
    window->settle();
    window->quit();
    EXPECT_EQ(window->exit_code(), 0) << window->errors();
}

// Whatever becomes of the ball, the window goes on; and it comes when it can.
TEST_F(PreviewOfMaterials, AFaultOfTheDriverIsSaid) {
    const auto window = open_on_faulty("", {{"CLARITY_COMPILE", ""}}, quick());
    ASSERT_EQ(window->command("tab Scene"), "");
    const Pixels before = window->picture();
    window->click_on("Materials");
    fault("build-refuses");
    window->click_on("row matt");  // and not by a pixel, whose rays have a kernel of their own
    ASSERT_TRUE(window->reaches(is_done));
    EXPECT_NE(std::string(window->state()["preview"]["failure"]).find("-11"), std::string::npos)
        << window->state()["preview"].dump();
    window->settle();
    EXPECT_EQ(window->state()["message"], "");
    ASSERT_EQ(window->command("set depth 2"), "");
    ASSERT_EQ(window->command("set depth 5"), "");
    window->settle();
    EXPECT_EQ(difference(window->picture(), before, 0), 0);
    fault("");
    const int material = window->state()["selected"]["material"];
    ASSERT_EQ(window->command("edit material." + std::to_string(material) + ".emission 1,0,0"), "");
    ball(*window, material);
}

// The window's own picture is on the device that does not answer: both are opened anew.
TEST_F(PreviewOfMaterials, AKernelThatNeverEndsIsLeft) {
    const auto window = open_on_faulty("other,gpu", {{"CLARITY_COMPILE", ""}, {"CLARITY_LAUNCH_LIMIT", "10"}}, quick());
    ASSERT_EQ(window->command("tab Scene"), "");
    const Pixels before = window->picture();
    ASSERT_EQ(window->command("pick 40 60"), "");
    const int material = (window->settle(), window->state()["selected"]["material"]);
    ball(*window, material);
    fault("launch-endless=1");
    ASSERT_EQ(window->command("edit material." + std::to_string(material) + ".color .1,.1,.8"), "");
    ASSERT_TRUE(window->reaches([](const auto& state) { return state["message"] != ""; }));
    fault("");
    window->key("ctrl+z");
    window->key("Left");
    window->key("Home");
    ASSERT_TRUE(window->reaches([](const auto& now) { return !now["behind"] && !now["busy"]; }));
    window->settle();
    EXPECT_EQ(difference(window->picture(), before, 0), 0);
    ball(*window, material);
}

}  // namespace
}  // namespace clarity::ui
