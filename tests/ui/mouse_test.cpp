// The mouse on the picture: clicks select, drags move, and neither does the other.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

constexpr int kWidth = 160, kHeight = 120;

// Writes a scene: two squares of one file side by side in the plane z = 0, a sphere above them, sky around them.
std::string write_scene(const std::string& folder) {
    std::ofstream(folder + "/square.obj") << "v -.8 -.8 0\nv .8 -.8 0\nv .8 .8 0\nv -.8 .8 0\nf 1 2 3 4\n";
    std::ofstream(folder + "/squares.scene") << "camera main eye 0 0 5 target 0 0 0 fov 40\n"
                                                "background .2 .3 .4\nambient .5\n"
                                                "light point position 0 2 4 color 1 1 1 intensity .3\n"
                                                "material red color .8 .1 .1 specular 0\n"
                                                "material green color .1 .8 .1 specular 0\n"
                                                "material white color .8 .8 .8 specular 0\n"
                                                "load square.obj translate -1 0 0 material red\n"
                                                "load square.obj translate 1 0 0 material green\n"
                                                "sphere center 0 1.3 0 radius .3 material white\n";
    return folder + "/squares.scene";
}

// The pixel that shows the point (x, y, 0).
Place pixel_of(double x, double y) {
    const double unit = kHeight / 2 / (5 * std::tan(20 * M_PI / 180));
    return {kWidth / 2 + x * unit - 0.5, kHeight / 2 - y * unit - 0.5};
}

// Reads one float a pixel, as AOVs are written, lowest row first.
std::vector<float> read_pfm(const std::string& path, int& width, int& height) {
    std::ifstream in(path, std::ios::binary);
    std::string kind;
    double scale = 0;
    in >> kind >> width >> height >> scale;
    in.get();
    if (kind != "Pf" || scale >= 0) {
        ADD_FAILURE() << path << ": `" << kind << "` and scale " << scale;
        return {};
    }
    std::vector<float> values(size_t(width) * size_t(height));
    in.read(reinterpret_cast<char*>(values.data()), std::streamsize(values.size() * sizeof(float)));
    if (!in) ADD_FAILURE() << path << ": too short";
    return values;
}

class Mouse : public WindowTest {
 protected:
    void SetUp() override {
        WindowTest::SetUp();
        if (IsSkipped()) return;
        window = open_scene(write_scene(folder.path()), std::to_string(kWidth) + "x" + std::to_string(kHeight));
    }
    Place at(double x, double y) { return window->place_of_pixel(pixel_of(x, y).x, pixel_of(x, y).y); }
    nlohmann::json selected_by_click(double x, double y) {
        window->click(at(x, y));
        window->settle();
        return window->state()["selected"];
    }
    std::array<int, 3> color(double x, double y) {
        const Pixels pixels = window->picture();
        const Place p = pixel_of(x, y);
        const size_t i = 3 * (size_t(std::lround(p.y)) * size_t(pixels.width) + size_t(std::lround(p.x)));
        return {pixels.rgb[i], pixels.rgb[i + 1], pixels.rgb[i + 2]};
    }
    void expect_same_view(const nlohmann::json& was) {
        const auto now = window->state();
        EXPECT_EQ(now["eye"], was["eye"]);
        EXPECT_EQ(now["target"], was["target"]);
    }

    TemporaryFolder folder;
    std::unique_ptr<WindowDriver> window;
};

TEST_F(Mouse, AClickSelectsTheInstanceAndItsMaterial) {
    const auto was = window->state();
    const auto left = selected_by_click(-1, 0.3);
    EXPECT_EQ(left["instance"], 0);
    const auto right = selected_by_click(1.2, -0.4);
    EXPECT_EQ(right["instance"], 1);
    EXPECT_NE(left["material"], right["material"]);
    const auto sphere = selected_by_click(0, 1.3);
    EXPECT_EQ(sphere["instance"], -1);
    EXPECT_GE(int(sphere["prim"]), 0);
    EXPECT_EQ(selected_by_click(-1.8, 1.5), (nlohmann::json{{"prim", -1}, {"instance", -1}, {"material", -1}}));
    expect_same_view(was);

    // The selected material has the colour that is seen there.
    const auto red = color(-1, 0.3), green = color(1.2, -0.4);
    EXPECT_GT(red[0], red[1] + 50);
    EXPECT_GT(green[1], green[0] + 50);
    ASSERT_EQ(window->command("edit material." + left["material"].dump() + ".color 0,0,1"), "");
    window->settle();
    EXPECT_GT(color(-1, 0.3)[2], color(-1, 0.3)[0] + 50);
    EXPECT_EQ(color(1.2, -0.4), green);
}

TEST_F(Mouse, ARightClickFollowsThePixelsRays) {
    ASSERT_EQ(window->command("set aov prim"), "");
    window->settle();
    const std::string path = folder.path() + "/prim.pfm";
    save(*window, path);
    int width = 0, height = 0;
    const std::vector<float> prims = read_pfm(path, width, height);
    ASSERT_EQ(width, kWidth);
    ASSERT_EQ(height, kHeight);
    ASSERT_EQ(window->command("set aov color"), "");
    window->settle();
    const auto was = window->state();
    std::vector<int> met;
    for (const auto& [x, y] :
         {std::pair(-1.2, 0.3), std::pair(-0.7, -0.4), std::pair(1.0, 0.2), std::pair(0.0, 1.3), std::pair(1.9, -1.4)}) {
        SCOPED_TRACE(std::to_string(x) + " " + std::to_string(y));
        const int px = int(std::lround(pixel_of(x, y).x)), py = int(std::lround(pixel_of(x, y).y));
        window->click(window->place_of_pixel(px, py), Button::right);
        window->settle();
        const auto inspection = window->query("inspection");
        EXPECT_EQ(inspection["x"], px);
        EXPECT_EQ(inspection["y"], py);
        ASSERT_FALSE(inspection["rays"].empty());
        const int prim = inspection["rays"][0]["prim"];
        EXPECT_EQ(prim, int(prims[size_t(kHeight - 1 - py) * kWidth + size_t(px)]));
        EXPECT_TRUE(window->query("layout")["rays"]);
        met.push_back(prim);
    }
    EXPECT_EQ(met.back(), -1);  // the sky
    EXPECT_NE(met[0], met[2]);
    EXPECT_EQ(window->state()["selected"]["prim"], -1);  // the sky selects nothing
    expect_same_view(was);

    // Shift and the left button do the same.
    window->key_down("shift");
    window->click(at(1.3, 0.3));
    window->key_up("shift");
    window->settle();
    EXPECT_EQ(window->query("inspection")["x"], std::lround(pixel_of(1.3, 0.3).x));
    EXPECT_EQ(window->state()["selected"]["prim"], -1);
}

TEST_F(Mouse, ADragOrbitsAndPicksNothing) {
    const auto was = window->state();
    window->drag(at(-1, 0), at(0, 0.4));
    window->settle();
    const auto now = window->state();
    EXPECT_EQ(now["selected"]["instance"], -1);
    EXPECT_EQ(now["target"], was["target"]);
    EXPECT_GT(distance_between(now["eye"], was["eye"]), 0.1);
    EXPECT_NEAR(distance_between(now["eye"], now["target"]), 5, 1e-3);
}

// Ctrl + drag: that part alone is traced, bit for bit, the rest is darker. Clicks find the pixels of the whole. V traces it
// all.
TEST_F(Mouse, ADragWithCtrlTracesAPart) {
    const auto was = window->state();
    const Pixels whole = window->picture();
    window->key_down("ctrl");
    window->drag(at(-1.6, 0.6), at(-0.4, -0.5));
    window->key_up("ctrl");
    window->settle();
    expect_same_view(was);
    const std::string line = window->query("command_line part.png")["command"];
    int x = 0, y = 0, w = 0, h = 0;
    const size_t option = line.find(" --crop ");
    ASSERT_NE(option, std::string::npos) << line;
    ASSERT_EQ(std::sscanf(line.c_str() + option, " --crop %d,%d,%d,%d", &x, &y, &w, &h), 4) << line;
    const Place first = pixel_of(-1.6, 0.6), last = pixel_of(-0.4, -0.5);
    EXPECT_NEAR(x, first.x, 2);
    EXPECT_NEAR(y, first.y, 2);
    EXPECT_NEAR(x + w, last.x, 2);
    EXPECT_NEAR(y + h, last.y, 2);
    const Pixels part = window->picture();
    ASSERT_EQ(part.width, kWidth);
    ASSERT_EQ(part.height, kHeight);
    const auto sum_of = [](const Pixels& of, int column, int row) {
        const unsigned char* const p = &of.rgb[3 * (size_t(row) * size_t(of.width) + size_t(column))];
        return p[0] + p[1] + p[2];
    };
    for (int row = 0; row < kHeight; ++row)
        for (int column = 0; column < kWidth; ++column) {
            const bool inside = column >= x && column < x + w && row >= y && row < y + h;
            const int now = sum_of(part, column, row), then = sum_of(whole, column, row);
            if (inside)
                ASSERT_EQ(now, then) << column << "," << row;
            else
                ASSERT_LT(now, std::max(1, then)) << column << "," << row;
        }
    EXPECT_EQ(selected_by_click(-1, 0)["instance"], 0);  // in the part
    EXPECT_EQ(selected_by_click(1, 0)["instance"], 1);   // and beside it
    const std::string saved = folder.path() + "/part.png";
    save(*window, saved);
    const Pixels file = read_png(saved);
    EXPECT_EQ(file.width, w);
    EXPECT_EQ(file.height, h);
    window->key("v");
    window->settle();
    EXPECT_EQ(difference(window->picture(), whole, 0), 0);
    EXPECT_EQ(std::string(window->query("command_line part.png")["command"]).find("--crop"), std::string::npos);
}

TEST_F(Mouse, TheViewersMapLooksAround) {
    ASSERT_EQ(window->command("map viewer"), "");
    const auto was = window->state();
    window->drag(at(-1, 0), at(0, 0.4));
    window->settle();
    const auto now = window->state();
    EXPECT_EQ(now["eye"], was["eye"]);
    EXPECT_GT(distance_between(now["target"], was["target"]), 0.1);
}

// A point in the target's plane follows the mouse.
TEST_F(Mouse, OtherButtonsShiftTheView) {
    for (const Button button : {Button::middle, Button::right}) {
        const auto was = window->state();
        const auto inspected = window->command("inspection");
        window->drag(at(-1, 0), at(-0.5, 0.25), button);
        window->settle();
        const auto now = window->state();
        const Point eye = now["eye"], eye_was = was["eye"], target = now["target"], target_was = was["target"];
        for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(eye[k] - eye_was[k], target[k] - target_was[k], 1e-4);
        EXPECT_NEAR(eye[0] - eye_was[0], -0.5, 0.05);
        EXPECT_NEAR(eye[1] - eye_was[1], -0.25, 0.05);
        EXPECT_EQ(now["selected"]["instance"], -1);
        EXPECT_EQ(window->command("inspection"), inspected);  // a right drag is no right click
        window->key("Home");
        window->settle();
    }
}

TEST_F(Mouse, TheWheelMovesTheCameraCloser) {
    const auto was = window->state();
    window->wheel(at(-1, 0), 3);
    window->settle();
    const auto near = window->state();
    EXPECT_EQ(near["target"], was["target"]);
    EXPECT_LT(distance_between(near["eye"], near["target"]), 4.5);
    window->wheel(at(-1, 0), -3);
    window->settle();
    EXPECT_LT(distance_between(window->state()["eye"], was["eye"]), 0.01);
}

TEST_F(Mouse, ADoubleClickLooksAtThePlace) {
    const auto was = window->state();
    window->double_click(at(1.2, -0.4));
    window->settle();
    const auto now = window->state();
    EXPECT_LT(distance_between(now["target"], {1.2, -0.4, 0}), 0.05);
    EXPECT_LT(distance_between(now["eye"], now["target"]), 0.9 * distance_between(was["eye"], was["target"]));
    // The sky gives no point to look at.
    window->double_click(window->place_of_pixel(2, 2));
    window->settle();
    expect_same_view(now);
}

TEST_F(Mouse, ADoubleClickCountsThoughNoFrameLiesBetween) {
    window->double_click_in_one_frame(at(1.2, -0.4));
    window->settle();
    EXPECT_LT(distance_between(window->state()["target"], {1.2, -0.4, 0}), 0.05);
}

TEST_F(Mouse, LightsAreDraggedInTheView) {
    window->key("l");
    ASSERT_TRUE(window->reaches([](const nlohmann::json& state) { return bool(state["show_lights"]); }));
    window->settle();
    const auto handles = window->query("layout")["handles"];
    ASSERT_EQ(handles.size(), 1u);
    const Place handle{handles[0]["x"], handles[0]["y"]};
    const auto was = window->state();
    const Pixels before = window->picture();
    window->drag(handle, {handle.x + 60, handle.y + 30});
    window->settle();
    const auto now = window->state();
    const Point light = now["light"], light_was = was["light"];
    EXPECT_GT(light[0], light_was[0] + 0.05);
    EXPECT_LT(light[1], light_was[1] - 0.02);
    EXPECT_NEAR(light[2], light_was[2], 1e-4);  // perpendicular to the line of sight
    expect_same_view(was);
    EXPECT_GT(difference(before, window->picture(), 1), 0.01);
    EXPECT_EQ(now["selected"]["instance"], -1);
}

// // While the camera moves, the frame rate counts more than pixels; at rest, all pixels are traced.

class Moving : public WindowTest {};

TEST_F(Moving, PicturesAreReducedAndSharpenAtRest) {
    const auto window = open();
    ASSERT_EQ(window->command("moving_fps 1000"), "");  // more than any machine reaches
    ASSERT_EQ(window->command("set spp 2"), "");
    window->settle();
    // Trace a few frames, so that the time of a frame is known.
    for (int i = 0; i < 3; ++i) {
        window->key("Left");
        window->settle();
    }
    window->key_down("Left");
    const bool reduced =
        window->reaches([](const nlohmann::json& state) { return state["reduced"] && state["size"] != "320x240"; });
    window->key_up("Left");
    EXPECT_TRUE(reduced);
    window->settle();
    const auto rest = window->state();
    EXPECT_FALSE(rest["reduced"]);
    EXPECT_EQ(rest["size"], "320x240");
    EXPECT_EQ(rest["samples"], 2);
    const Pixels sharp = window->picture();
    EXPECT_EQ(sharp.width, 320);

    // The final picture equals that of a window which never moved.
    const TemporaryFolder folder;
    const std::string path = folder.path() + "/fresh.png", line = command_line(*window, path);
    ASSERT_EQ(run_command_line(line), 0) << line;
    EXPECT_EQ(difference(sharp, read_png(path), 0), 0) << line;
}

TEST_F(Moving, FullResolutionIfRequested) {
    const auto window = open();
    ASSERT_EQ(window->command("moving_fps 0"), "");
    window->key("Left");
    window->settle();
    window->key_down("Left");
    const auto begin = std::chrono::steady_clock::now();
    int seen = 0;
    for (; seconds_since(begin) < 1; ++seen) EXPECT_FALSE(window->state()["reduced"]);  // no clock: it looks for so long
    window->key_up("Left");
    EXPECT_GT(seen, 0);
    window->settle();
}

}  // namespace
}  // namespace clarity::ui
