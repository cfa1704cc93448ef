// Two settings of the same view, side by side.
#include <gtest/gtest.h>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

class Compare : public WindowTest {
 protected:
    static bool both_there(const nlohmann::json& state) { return state.contains("other") && !state["busy"]; }
    // Opens a comparison with the key C: the second side begins as a copy, then gets another structure.
    std::unique_ptr<WindowDriver> compared() {
        auto window = open();
        window->key("c");
        EXPECT_TRUE(window->reaches(both_there));
        EXPECT_EQ(window->command("compare b"), "");
        EXPECT_EQ(window->command("accel spheres"), "");
        window->settle();
        return window;
    }
    // The share of dark pixels in an area of the window.
    static double dark(const Pixels& screen, const nlohmann::json& area) {
        size_t count = 0, all = 0;
        for (int y = int(area[1]) + int(area[3]) / 5; y < int(area[1]) + int(area[3]) * 4 / 5; ++y)
            for (int x = int(area[0]) + 10; x < int(area[0]) + int(area[2]) - 10; ++x, ++all) {
                const unsigned char* p = &screen.rgb[3 * (size_t(y) * size_t(screen.width) + size_t(x))];
                count += p[0] < 16 && p[1] < 16 && p[2] < 16;
            }
        return all > 0 ? double(count) / double(all) : 0;
    }
};

TEST_F(Compare, TwoStructuresShowTheSamePicture) {
    const auto window = compared();
    const auto state = window->state();
    EXPECT_EQ(state["accel"], "bvh8");
    EXPECT_EQ(state["other"]["accel"], "spheres");
    ASSERT_TRUE(state.contains("difference"));
    EXPECT_LT(double(state["difference"]["share"]), 1e-3);  // pixels at silhouettes may differ
    EXPECT_GT(double(state["fps"]), 0);
    EXPECT_GT(double(state["other"]["frame_ms"]), 0);
    // A visible difference is measured.
    ASSERT_EQ(window->command("set depth 1"), "");
    window->settle();
    EXPECT_GT(double(window->state()["difference"]["share"]), 0.02);
    EXPECT_EQ(window->state()["message"], "");
}

// The caption counts kernels by the devices' clocks, as the Stats tab does, and says so.
TEST_F(Compare, TheCaptionSaysWhatItCounts) {
    const auto window = compared();
    ASSERT_EQ(window->command("accel linear"), "");
    ASSERT_EQ(window->command("set packet 1x1"), "");  // and slow
    window->settle();
    const auto state = window->state();
    double ms[2] = {};
    for (int side = 0; side < 2; ++side) {
        const std::string speed = (side == 0 ? state : state["other"])["caption"]["speed"];
        const size_t at = speed.find(" ms of kernels, ");
        ASSERT_NE(at, std::string::npos) << speed;
        ms[side] = std::stod(speed);
    }
    if (clocks_count()) {
        EXPECT_LT(ms[0], ms[1]);
        EXPECT_LT(ms[1], double(state["other"]["frame_ms"]) * 3);
    }
    const std::string verdict = state["caption"]["verdict"];
    EXPECT_NE(verdict.find("faster"), std::string::npos) << verdict;
    EXPECT_NEAR(std::stod(verdict), ms[1] / ms[0], 0.05 * ms[1] / ms[0]);
    EXPECT_EQ(state["other"]["caption"]["verdict"], "");
}

TEST_F(Compare, TheHandleIsDraggedByTheMouse) {
    const auto window = compared();
    const auto layout = window->query("layout");
    ASSERT_EQ(layout["places"].size(), 2u);
    const auto area = layout["places"][0]["area"], right = layout["places"][1]["shown"];
    const Place handle{double(right[0]), double(area[1]) + double(area[3]) / 3};
    const auto was = window->state();
    window->drag(handle, {handle.x - 0.25 * double(area[2]), handle.y});
    window->settle();
    const auto now = window->state();
    EXPECT_NEAR(double(now["wipe"]), double(was["wipe"]) - 0.25, 0.03);
    EXPECT_EQ(now["eye"], was["eye"]);
    EXPECT_NEAR(double(window->query("layout")["places"][1]["shown"][0]), handle.x - 0.25 * double(area[2]), 8);
    // A drag beside the handle moves the camera of both sides.
    window->drag({handle.x + 60, handle.y}, {handle.x + 120, handle.y});
    window->settle();
    EXPECT_NE(window->state()["eye"], was["eye"]);
    EXPECT_EQ(window->state()["wipe"], now["wipe"]);
    EXPECT_LT(double(window->state()["difference"]["share"]), 1e-3);
}

TEST_F(Compare, DifferenceIsDarkWhereNothingDiffers) {
    const auto window = compared();
    const auto area = window->query("layout")["places"][0]["area"];
    EXPECT_LT(dark(window->screenshot(), area), 0.5);
    ASSERT_EQ(window->command("mode difference"), "");
    window->settle();
    const auto widget_rects = window->query("layout")["places"];
    ASSERT_EQ(widget_rects.size(), 1u);
    EXPECT_GT(dark(window->screenshot(), widget_rects[0]["area"]), 0.97);
    ASSERT_EQ(window->command("set depth 1"), "");
    window->settle();
    EXPECT_LT(dark(window->screenshot(), widget_rects[0]["area"]), 0.97);
}

TEST_F(Compare, SideBySideBothPicturesCanBeClicked) {
    const auto window = compared();
    ASSERT_EQ(window->command("mode side"), "");
    window->settle();
    const auto widget_rects = window->query("layout")["places"];
    ASSERT_EQ(widget_rects.size(), 2u);
    EXPECT_LE(double(widget_rects[0]["area"][0]) + double(widget_rects[0]["area"][2]), double(widget_rects[1]["area"][0]));
    nlohmann::json selected[2];
    for (const auto& [x, y] : {std::pair(20, 225), std::pair(210, 150)}) {  // the floor, the ball of glass
        for (size_t side : {0u, 1u}) {
            ASSERT_EQ(window->command("pick 160 120"), "");  // pick something else first
            window->settle();
            window->click(window->place_of_pixel(x, y, side));
            window->settle();
            selected[side] = window->state()["selected"];
            EXPECT_GE(int(selected[side]["prim"]), 0);
        }
        EXPECT_EQ(selected[0], selected[1]);
        ASSERT_EQ(window->command("pick " + std::to_string(x) + " " + std::to_string(y)), "");
        window->settle();
        EXPECT_EQ(window->state()["selected"], selected[0]);
    }
}

TEST_F(Compare, SidesCanBeSwappedAndOneClosed) {
    const auto window = compared();
    const Pixels before = window->picture();
    window->key("x");
    window->settle();
    EXPECT_EQ(window->state()["accel"], "spheres");
    EXPECT_EQ(window->state()["other"]["accel"], "bvh8");
    window->key("x");
    window->settle();
    window->key("c");
    window->settle();
    const auto state = window->state();
    EXPECT_FALSE(state["comparing"]);
    EXPECT_FALSE(state.contains("other"));
    EXPECT_EQ(state["accel"], "bvh8");
    EXPECT_EQ(window->query("layout")["places"].size(), 1u);
    EXPECT_EQ(difference(before, window->picture(), 0), 0);
    EXPECT_EQ(state["message"], "");
}

// If the second side cannot be prepared, a message says so and the first side goes on.
TEST_F(Compare, AnImpossibleSecondSideGivesAMessage) {
    const auto window = compared();
    const Pixels before = window->picture();
    ASSERT_EQ(window->command("device 99:99"), "");
    window->settle();
    EXPECT_NE(window->state()["message"], "");
    EXPECT_EQ(difference(before, window->picture(), 0), 0);
    ASSERT_EQ(window->command("compare off"), "");
    window->settle();
    window->key("Left");
    window->settle();
    EXPECT_GT(difference(before, window->picture()), 0.01);
}

}  // namespace
}  // namespace clarity::ui
