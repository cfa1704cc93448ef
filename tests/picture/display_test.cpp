// display_test.cpp -- a picture after tracing: tone mapping, false colours and their scale, distances for overlays, times.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "picture/false_colors.hpp"
#include "support/generated.hpp"
#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

ScenePtr primitives() {
    return load_scene(source_file("scenes/primitives.scene"));
}

// The 8-bit sRGB code that a background of this colour gets.
std::array<int, 3> shown(const Settings& settings, const std::array<float, 3>& color) {
    static const ScenePtr empty = shared_scene(scene_of(TriangleMesh()));
    View view = view_from({0, 0, 5}, {0, 0, 0}, 40);
    view.background = color;
    bench().trace(empty, settings, view);
    const ByteImage image = bench().frames().read_display(settings);
    return {image.pixels[0], image.pixels[1], image.pixels[2]};
}

double srgb(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055);
}

// The sigmoid of AgX as published: pivot at middle grey, slope 2, powers 3 and 3.25.
double agx(double x) {
    constexpr double kX0 = 10 / 16.5, kY0 = 0.5, kSlope = 2;
    x = std::clamp((std::log2(std::max(x, 1e-10)) - std::log2(0.18) + 10) / 16.5, 0.0, 1.0);
    const double power = x < kX0 ? 3 : 3.25, end_x = x < kX0 ? kX0 : 1 - kX0, end_y = x < kX0 ? kY0 : 1 - kY0;
    const double run = kSlope * end_x;
    const double scale = std::pow(std::pow(run, -power) * (std::pow(run / end_y, power) - 1), -1 / power);
    const double u = kSlope * (x - kX0) / scale;
    return 255 * (kY0 + scale * u / std::pow(1 + std::pow(std::fabs(u), power), 1 / power));
}

TEST(Tones, FollowTheirCurves) {
    Settings settings = make_settings({{"size", "1x1"}});
    for (int i = 0; i <= 60; ++i) {
        const double x = i == 0 ? 0 : std::pow(2.0, -9 + i * 0.2);
        const float f = static_cast<float>(x);
        const auto check = [&](const char* tone, double wanted, double tolerance) {
            settings.tone = tone;
            const std::array<int, 3> code = shown(settings, {f, f, f});
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(code[k], wanted, tolerance) << tone << " of " << x << ", channel " << k;
        };
        check("linear", srgb(x), 0.6);
        check("reinhard", srgb(x / (1 + x)), 0.6);
        check("aces", srgb(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)), 0.6);
        check("agx", agx(x), 1.5);
    }
}

TEST(Tones, ExposureIsAFactor) {
    Settings settings = make_settings({{"size", "1x1"}});
    const std::array<int, 3> plain = shown(settings, {0.4f, 0.2f, 0.1f});
    settings.exposure = 2;
    EXPECT_EQ(shown(settings, {0.2f, 0.1f, 0.05f}), plain);
}

// A lamp that grows brighter turns white with AgX, and keeps a hue with the clipped curve.
TEST(Tones, AgxBleachesBrightColors) {
    Settings settings = make_settings({{"size", "1x1"}, {"tone", "agx"}});
    const std::array<int, 3> dim = shown(settings, {0.3f, 0.02f, 0.02f}), bright = shown(settings, {30, 2, 2});
    EXPECT_GT(dim[0] - dim[1], 60);
    EXPECT_LT(bright[0] - bright[1], 35);
    settings.tone = "linear";
    const std::array<int, 3> clipped = shown(settings, {30, 0.5f, 0.02f});
    EXPECT_GT(clipped[0] - clipped[2], 200);
}

TEST(Display, MatchesTheFilm) {
    const View view = make_view(*primitives(), 4.0f / 3);
    for (const char* size : {"1x1", "3x1", "5x3", "64x48", "33x31"}) {
        const Settings settings = make_settings({{"size", size}});
        FrameStats stats = bench().trace(primitives(), settings, view);
        FalseColorScale scale;
        scale.map = FalseColorScale::Map::heat;
        const ByteImage image = bench().frames().read_display(settings, &stats, &scale);
        EXPECT_EQ(scale.map, FalseColorScale::Map::none);
        EXPECT_EQ(image.pixels.size(), size_t(image.width) * image.height * 4);
        // The same rows, read into the caller's memory.
        std::vector<uint8_t> memory(image.pixels.size() + 64, 0xAB);
        std::vector<KernelTime> times;
        bench().frames().read_display(settings, memory.data(), times);
        EXPECT_TRUE(std::equal(image.pixels.begin(), image.pixels.end(), memory.begin())) << size;
        for (size_t i = image.pixels.size(); i < memory.size(); ++i) ASSERT_EQ(memory[i], 0xAB) << size << ": written beyond";
        ASSERT_EQ(stats.kernels.size(), 4u);
        const char* const names[] = {"trace", "counters", "tone map", "read-back"};
        for (int i = 0; i < 4; ++i) {
            EXPECT_EQ(stats.kernels[i].name, names[i]);
            EXPECT_GE(stats.kernels[i].ms, 0);
        }
        EXPECT_EQ(stats.kernels[0].ms, stats.device_ms);
    }
}

// A picture keeps its content while others of any size are made. Only the memory of a picture that nothing holds is used again.
TEST(Display, PixelsStayUnchangedWhileTheyAreHeld) {
    const char* const eyes[] = {"0,2.5,11,0,2.2,0,50", "3,2.5,9,0,2.2,0,50"};
    std::vector<std::pair<ByteImage, std::vector<uint8_t>>> kept;
    const auto all_stay = [&] {
        for (const auto& [image, bytes] : kept)
            if (!std::equal(bytes.begin(), bytes.end(), image.pixels.begin(), image.pixels.end())) return false;
        return true;
    };
    for (const char* size : {"64x48", "5x3", "33x31", "128x96", "64x48"})
        for (const char* eye : eyes) {
            const Settings settings = make_settings({{"size", size}});
            FrameStats stats = bench().trace(primitives(), settings, make_view(*primitives(), 4.0f / 3, eye));
            for (int again = 0; again < 2; ++again) {
                const ByteImage image = bench().frames().read_display(settings, &stats);
                EXPECT_TRUE(!again || image.pixels == kept.back().first.pixels) << size << " from " << eye;
                kept.emplace_back(image, std::vector<uint8_t>(image.pixels.begin(), image.pixels.end()));
            }
            EXPECT_EQ(stats.kernels.size(), 6u);
            EXPECT_TRUE(all_stay()) << size << " from " << eye;
        }
    const Settings settings = make_settings({{"size", "128x96"}});
    bench().trace(primitives(), settings, make_view(*primitives(), 4.0f / 3));
    const uint8_t* const place = bench().frames().read_display(settings).pixels.data();
    EXPECT_EQ(bench().frames().read_display(settings).pixels.data(), place);
    const Settings steps = make_settings({{"size", "64x48"}, {"aov", "steps"}});
    bench().trace(primitives(), steps, make_view(*primitives(), 4.0f / 3));
    FalseColorScale scale;
    EXPECT_EQ(bench().frames().read_display(steps, nullptr, &scale).pixels.size(), 64u * 48u * 4u);
    EXPECT_NE(scale.map, FalseColorScale::Map::none);
    EXPECT_TRUE(all_stay());
}

// The picture's distances equal those of AOV `t`, whatever the packets and sizes are. Later samples do not change them.
TEST(Display, DistancesMatchThePicture) {
    const ScenePtr scene = primitives();
    const View view = make_view(*scene, 4.0f / 3, "0,2.5,11,0,2.2,0,50");
    for (const auto& [configuration, size] :
         std::vector<std::pair<Configuration, std::string>>{{{"bvh2", 16, 4, 4}, "160x120"},
                                                            {{"bvh2", 16, 3, 5}, "61x47"},
                                                            {{"bvh2", 4, 8, 8}, "33x30"},
                                                            {{"bvh2", 1, 1, 1}, "17x3"},
                                                            {{"bvh2", 16, 4, 4}, "1x1"},
                                                            {{"bvh2", 16, 2, 2}, "29x31"}}) {
        Settings settings = make_settings({{"size", size}, {"aov", "t"}});
        configuration.apply(settings);
        bench().trace(scene, settings, view);
        const FloatImage t = bench().frames().read_values();
        EXPECT_EQ(bench().frames().read_distance().pixels, t.pixels);
        settings.aov = "color";
        bench().trace(scene, settings, view);
        const FloatImage distance = bench().frames().read_distance();
        ASSERT_EQ(distance.pixels.size(), t.pixels.size());
        EXPECT_EQ(distance.channels, 1u);
        size_t nothing = 0;
        for (size_t i = 0; i < t.pixels.size(); ++i) {
            nothing += std::isinf(distance.pixels[i]);
            if (std::isinf(t.pixels[i]))
                EXPECT_EQ(distance.pixels[i], t.pixels[i]);
            else
                EXPECT_FLOAT_EQ(distance.pixels[i], t.pixels[i]) << configuration.text() << ", " << size << ", pixel " << i;
        }
        if (size == "160x120") {
            EXPECT_GT(nothing, 1000u);
            EXPECT_LT(nothing, t.pixels.size() / 2);
        }
        bench().trace(scene, settings, view, 1);
        EXPECT_EQ(bench().frames().read_distance().pixels, distance.pixels) << "sample 1 changed the distances";
    }
    Settings settings = make_settings({{"size", "20x20"}, {"aov", "normal"}});
    bench().trace(scene, settings, view);
    EXPECT_TRUE(bench().frames().read_distance().pixels.empty());
    EXPECT_TRUE(FrameRenderer(bench().shared_device()).read_distance().pixels.empty());
}

TEST(View, MaterialsReplaceTheScenes) {
    const ScenePtr scene = primitives();
    View view = make_view(*scene, 4.0f / 3);
    EXPECT_TRUE(view.materials.empty());
    const Settings settings = make_settings({{"size", "80x60"}});
    const auto picture = [&](const ScenePtr& of) {
        bench().trace(of, settings, view);
        return bench().frames().read_values().pixels;
    };
    const FloatPixels before = picture(scene);
    for (const Material& material : scene->materials) view.materials.push_back(material.values);
    EXPECT_EQ(picture(scene), before) << "the scene's own materials, given by the view, change the picture";
    auto repainted = std::make_shared<Scene>(*scene);
    for (size_t i = 0; i < view.materials.size(); ++i) {
        view.materials[i].color[i % 3] *= 0.3f;
        view.materials[i].reflect = 0.5f * view.materials[i].reflect + 0.1f;
        repainted->materials[i].values = view.materials[i];
    }
    const auto prepared = bench().prepare(scene, settings);
    const FloatPixels edited = picture(scene);
    EXPECT_EQ(bench().prepare(scene, settings)->accel, prepared->accel) << "an edit caused a new build";
    EXPECT_NE(edited, before);
    view.materials.clear();
    EXPECT_EQ(edited, picture(repainted)) << "differs from a scene that has these materials";
    EXPECT_EQ(picture(scene), before) << "the edit still has an effect";

    view.materials.assign(scene->materials.size() + 1, rt_material{});
    EXPECT_THROW(picture(scene), Error);
    view.materials.pop_back();
    view.materials[0].texture = 1000;
    EXPECT_THROW(picture(scene), Error);
    view.materials.clear();
    EXPECT_EQ(picture(scene), before) << "a refused view affected the next picture";
}

TEST(Generations, CountTheDepthOfRays) {
    const ScenePtr scene = primitives();
    const View view = make_view(*scene, 4.0f / 3);
    const auto picture = [&](int depth) {
        const Settings settings =
            make_settings({{"size", "160x120"}, {"aov", "generations"}, {"depth", std::to_string(depth)}});
        bench().trace(scene, settings, view);
        return bench().frames().read_values();
    };
    for (const float value : picture(1).pixels) EXPECT_EQ(value, 1);
    const FloatImage deep = picture(6), shallow = picture(3);
    size_t deepest = 0;
    for (size_t i = 0; i < deep.pixels.size(); ++i) {
        EXPECT_GE(deep.pixels[i], 1);
        EXPECT_LE(deep.pixels[i], 6);
        EXPECT_EQ(shallow.pixels[i], std::min(deep.pixels[i], 3.0f));
        deepest += deep.pixels[i] == 6;
    }
    EXPECT_GT(deepest, 10u);
}

FloatImage ramp(unsigned count, float step) {
    FloatImage image{count, 1, 1, {}};
    for (unsigned i = 0; i < count; ++i) image.pixels.push_back(float(i) * step);
    return image;
}

double lightness(const std::array<uint8_t, 3>& color) {  // CIE L*
    const double weights[3] = {0.2126, 0.7152, 0.0722};
    double luminance = 0;
    for (int k = 0; k < 3; ++k) {
        const double c = color[k] / 255.0;
        luminance += weights[k] * (c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    return luminance > 0.008856 ? 116 * std::cbrt(luminance) - 16 : 903.3 * luminance;
}

TEST(FalseColors, RiseInEvenSteps) {
    const FalseColorScale scale = scale_of(ramp(101, 1), "steps");
    EXPECT_EQ(scale.min, 0);
    EXPECT_EQ(scale.max, 100);
    EXPECT_TRUE(scale.whole);
    EXPECT_FALSE(scale.label.empty());
    const double whole = lightness(color_at(scale, 1)) - lightness(color_at(scale, 0));
    EXPECT_GT(whole, 75);
    for (int i = 0; i < 20; ++i) {
        const double step = lightness(color_at(scale, (i + 1) / 20.0f)) - lightness(color_at(scale, i / 20.0f));
        EXPECT_GT(step, 0.5 * whole / 20) << i;
        EXPECT_LT(step, 1.6 * whole / 20) << i;
    }
}

TEST(FalseColors, MatchTheColorBar) {
    FloatImage values = ramp(101, 2);
    values.pixels[50] = INFINITY;
    values.pixels[51] = NAN;
    for (const char* aov : {"steps", "leaf_tests", "t"}) {
        const FalseColorScale scale = scale_of(values, aov);
        EXPECT_EQ(scale.max, 200) << aov;
        const SharedBytes rgba = false_colors(values, aov, scale).pixels;
        for (unsigned i = 0; i <= 100; ++i) {
            const std::array<uint8_t, 3> wanted =
                i == 50 || i == 51 ? std::array<uint8_t, 3>{}
                                   : color_at(scale, (values.pixels[i] - scale.min) / (scale.max - scale.min));
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(rgba[4 * i + k], wanted[k], 3) << aov << " " << i;
            EXPECT_EQ(rgba[4 * i + 3], 255);
        }
    }
    const FalseColorScale short_scale = scale_of(values, "steps", 10);
    EXPECT_EQ(short_scale.max, 10);
    EXPECT_EQ(false_colors(values, "steps", short_scale).pixels[4 * 100], color_at(short_scale, 1)[0]);
    EXPECT_EQ(scale_of(values, "lanes").max, 1);
    EXPECT_EQ(scale_of(values, "normal").map, FalseColorScale::Map::none);
    // No values, a single value, and only misses.
    EXPECT_GT(scale_of(ramp(1, 0), "steps").max, 0);
    FloatImage misses = ramp(3, 1);
    for (float& value : misses.pixels) value = INFINITY;
    const FalseColorScale none = scale_of(misses, "t");
    EXPECT_TRUE(std::isfinite(none.min) && std::isfinite(none.max));
    EXPECT_EQ(false_colors(misses, "t", none).pixels[0], 0);
    for (const float position : {-1.0f, 2.0f, float(NAN), float(INFINITY)}) color_at(scale_of(values, "steps"), position);
}

// A frame of the device, with the end of the scale chosen by the user.
TEST(FalseColors, FrameWithAScaleSetByTheUser) {
    Settings settings = make_settings({{"size", "64x48"}, {"aov", "steps"}});
    bench().trace(primitives(), settings, make_view(*primitives(), 4.0f / 3));
    const FloatImage values = bench().frames().read_values();
    FrameStats stats;
    FalseColorScale scale;
    bench().frames().read_display(settings, &stats, &scale);
    EXPECT_EQ(scale.max, *std::max_element(values.pixels.begin(), values.pixels.end()));
    EXPECT_EQ(stats.kernels.size(), 2u);
    settings.scale_max = 7;
    bench().frames().read_display(settings, nullptr, &scale);
    EXPECT_EQ(scale.max, 7);
}

}  // namespace
