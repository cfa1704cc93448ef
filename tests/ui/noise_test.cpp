// noise_test.cpp -- the Inspect tab says why a pixel of `path` is noisy, by a button; its samples are the picture's, its paths
// are drawn in the scene and saved.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "base/pictures/picture_read.hpp"
#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

class Noise : public WindowTest {
 protected:
    void SetUp() override {
        WindowTest::SetUp();
        if (IsSkipped()) return;
        const std::string scene = folder.path() + "/caustic.scene";
        std::ofstream(scene) << "background 0 0 0\ncamera main eye 0 3 6 target 0 0 0 fov 40\n"
                                "light sphere center 0 6 -2 radius .2 radiance 300 name bulb\n"
                                "material floor model lambert color .7\nmaterial clear model dielectric color 1 ior 1.5\n"
                                "plane normal 0 1 0 offset 0 material floor\nsphere center 0 1.2 -.4 radius 1 material clear\n";
        window = open_scene(scene, "64x48");
        for (const char* line : {"set tracer path", "set spp 300", "tab Inspect"}) ASSERT_EQ(window->command(line), "");
        window->settle();
        ASSERT_EQ(window->command("inspect 32 24"), "");
        window->settle();
    }
    TemporaryFolder folder;
    std::unique_ptr<WindowDriver> window;
};

TEST_F(Noise, AButtonExplainsThePixelAndDrawsItsPaths) {
    const Pixels before = window->screenshot();
    window->click_on("Why is this pixel noisy?");
    ASSERT_TRUE(
        window->reaches([&](const nlohmann::json&) { return window->command("noise").find("no pixel") == std::string::npos; }));
    window->settle();
    const auto noise = window->query("noise");
    EXPECT_EQ(noise["cause"], "caustic") << noise;
    EXPECT_NE(std::string(noise["sentence"]).find("lamp `bulb`"), std::string::npos) << noise;
    EXPECT_EQ(noise["samples"], 300);
    // The mean is the picture's pixel, bit for bit.
    const std::string path = folder.path() + "/film.pfm";
    save(*window, path);
    const FloatImage film = read_picture(path);
    const size_t at = 3 * (size_t(noise["y"]) * film.width + size_t(noise["x"]));
    for (size_t k = 0; k < 3; ++k) EXPECT_EQ(float(noise["mean"][k]), film.pixels[at + k]);
    EXPECT_GT(film.pixels[at], 0);
    // The picture's half of the window shows lines now.
    const Pixels after = window->screenshot();
    size_t changed = 0;
    for (int y = 0; y < after.height; ++y)
        for (int x = 0; x < after.width / 2; ++x) {
            const size_t i = 3 * (size_t(y) * size_t(after.width) + size_t(x));
            changed += std::abs(int(after.rgb[i]) - int(before.rgb[i])) > 40;
        }
    EXPECT_GT(changed, 300u);
}

// The Stats tab shows how the error falls. Pixels that rest are seen in the mean number of samples.
TEST_F(Noise, TheErrorIsSeenToFall) {
    for (const char* line : {"set sampler independent", "tab Stats"}) ASSERT_EQ(window->command(line), "");
    window->settle();
    const auto all = window->state()["convergence"];
    EXPECT_LT(double(all["slope"]), -0.1) << all << "the first samples have found few bright paths";
    const auto& points = all["points"];
    ASSERT_EQ(points.size(), 15u) << all;  // 2, 3, 4, 6, 8 ... 256
    EXPECT_EQ(points[0][0], 2);
    EXPECT_EQ(points[6][0], 16);
    EXPECT_EQ(points.back()[0], 256);
    EXPECT_NEAR(double(points[6][2]) / double(points.back()[2]), 4, 1.5) << all;
    for (size_t i = 1; i < points.size(); ++i) EXPECT_GT(double(points[i][1]), double(points[i - 1][1])) << "seconds";
    for (const char* plot : {"error by samples", "error by seconds"})
        EXPECT_GT(double(window->query(std::string("find ") + plot)["w"]), 100) << plot;
    ASSERT_EQ(window->command("set adaptive 0.5"), "");
    nlohmann::json some;
    ASSERT_TRUE(window->reaches([&](const nlohmann::json& state) {
        const auto& now = state["convergence"]["points"];
        return now.size() == 15 && (some = now.back()) != points.back();
    }));
    EXPECT_LT(double(some[0]), 200) << some;
    EXPECT_GT(double(some[0]), 32) << some;
    EXPECT_GE(double(some[2]), 0.9 * double(points.back()[2])) << some;
}

// In the same seconds a side gets more samples if they are cheaper.
TEST_F(Noise, SidesGetTheSameTime) {
    window->key("c");
    ASSERT_TRUE(window->reaches([](const nlohmann::json& state) { return state.contains("other"); }));
    for (const char* line : {"set size 256x192", "set spp 100", "compare b", "set depth 1", "tab Render"})
        ASSERT_EQ(window->command(line), "");
    window->settle();
    EXPECT_EQ(window->state()["caption"]["noise"], "");
    window->click_on("Equal time");
    nlohmann::json a, b;
    ASSERT_TRUE(window->reaches([&](const nlohmann::json& state) {
        a = state["convergence"]["points"], b = state["other"]["convergence"]["points"];
        return state["samples"] == 100 && !a.empty() && a.back()[0] == 100 && !b.empty() &&
               state["other"]["caption"]["noise"] != "";
    }));
    EXPECT_GT(double(b.back()[0]), 130) << b;
    EXPECT_GE(double(b.back()[1]), double(a.back()[1])) << a << b;
    EXPECT_LT(double(b.back()[1]), double(a.back()[1]) + 1) << a << b << "a sample more, on a busy machine";
    window->settle();
    const auto state = window->state();
    EXPECT_NE(std::string(state["caption"]["noise"]).find("of error, 100 samples in"), std::string::npos) << state["caption"];
}

// While the camera moves the picture has no noise; at rest it has its samples as they are.
TEST_F(Noise, MovingPicturesAreDenoised) {
    ASSERT_EQ(window->command("set spp 4"), "");
    window->settle();
    EXPECT_FALSE(window->state()["denoised"]);
    window->key_down("Left");
    const bool moving = window->reaches([](const nlohmann::json& state) { return state["denoised"] == true; });
    window->key_up("Left");
    EXPECT_TRUE(moving);
    window->settle();
    EXPECT_FALSE(window->state()["denoised"]);
    EXPECT_EQ(window->state()["samples"], 4);
    const Pixels noisy = window->picture();
    ASSERT_EQ(window->command("set denoise on"), "");
    window->settle();
    EXPECT_TRUE(window->state()["denoised"]);
    EXPECT_GT(difference(window->picture(), noisy, 4), 0.1);
    ASSERT_EQ(window->command("set denoise off"), "");
    window->settle();
    EXPECT_EQ(difference(window->picture(), noisy, 0), 0) << "the film has kept its samples";
    window->key_down("Left");
    EXPECT_FALSE(window->reaches([](const nlohmann::json& state) { return state["denoised"] == true; }, 1));
    window->key_up("Left");
}

TEST_F(Noise, WhatCannotBeExplainedIsSaid) {
    ASSERT_EQ(window->command("why 32 24"), "");
    window->settle();
    EXPECT_EQ(window->query("noise")["cause"], "caustic");
    ASSERT_EQ(window->command("set tracer iterative"), "");
    window->settle();
    ASSERT_EQ(window->command("why 32 24"), "");
    window->settle();
    EXPECT_NE(window->command("noise").find("only pictures of the tracer `path`"), std::string::npos);
    ASSERT_EQ(window->command("set tracer path"), "");
    window->settle();
    ASSERT_EQ(window->command("why 64 24"), "");
    window->settle();
    EXPECT_NE(window->command("noise").find("no pixel 64,24"), std::string::npos);
}

}  // namespace
}  // namespace clarity::ui
