// adaptive_test.cpp -- pixels rest when they have samples enough: the picture shows the same light with less work, and is the
// same bit by bit however it is traced.
#include <cmath>
#include <cstdio>
#include <cstring>

#include "picture/film_noise.hpp"
#include "stand/team.hpp"
#include "support/scratch.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

ScenePtr scene_of_text(const std::string& text) {
    const Scratch folder;
    return load_scene(folder.write("a.scene", text));
}

// Soft shadows of a lamp, which is noise only at their edges.
ScenePtr soft_shadow() {
    return scene_of_text(
        "camera main eye 0 1 4 target 0 1 0 fov 40\nlight rect center 0 3 0 u 1 0 0 v 0 0 1 radiance 4 4 4\n"
        "material white model lambert color .7 .7 .7\nplane normal 0 1 0 offset 0 material white\n"
        "sphere center 0 1 0 radius .7 material white\n");
}
// A caustic: few of its paths are bright.
ScenePtr caustic() {
    return scene_of_text(
        "camera main eye 0 3 4 target 0 0 0 fov 45\nbackground .1 .1 .1\n"
        "light sphere center 2 4 0 radius .6 radiance 20 18 14\n"
        "material white model lambert color .7 .7 .7\nplane normal 0 1 0 offset 0 material white\n"
        "material glass model dielectric ior 1.5\nsphere center 0 .8 0 radius .8 material glass\n");
}

struct Picture {
    FloatImage sums;
    uint64_t primary = 0;
    size_t pixels() const { return sums.pixels.size() / 8; }
    double count(size_t i) const { return sums.pixels[4 * i + 3]; }
    double light(size_t i) const { return sums.pixels[4 * i + 1] / count(i); }  // green
    double mean() const {
        double sum = 0;
        for (size_t i = 0; i < pixels(); ++i) sum += light(i);
        return sum / double(pixels());
    }
    // Squared standard error of mean().
    double error_squared() const {
        double sum = 0;
        for (size_t i = 0; i < pixels(); ++i) sum += std::fabs(sums.pixels[4 * (pixels() + i) + 3]) / (count(i) - 1) / count(i);
        return sum / std::pow(double(pixels()), 2);
    }
    double samples() const { return film_noise(sums).mean_samples; }
};

Settings adaptive_settings(const std::vector<std::pair<std::string, std::string>>& more) {
    std::vector<std::pair<std::string, std::string>> all = {{"tracer", "path"}, {"accel", "bvh2"},          {"size", "32x32"},
                                                            {"depth", "6"},     {"sampler", "independent"}, {"packet", "8x8"}};
    all.insert(all.end(), more.begin(), more.end());
    return make_settings(all);
}

Picture traced(Team& team, const ScenePtr& scene, const Settings& settings, unsigned samples, unsigned in_a_call = 4096) {
    Picture picture;
    for (unsigned first = 0; first < samples; first += in_a_call)
        picture.primary +=
            team.trace(scene, settings, make_view(*scene, 1), first, std::min(in_a_call, samples - first)).primary;
    picture.sums = team.frames.read_sums();
    return picture;
}

class Adaptive : public ::testing::Test {};

TEST_F(Adaptive, ShowsTheLightOfAllSamples) {
    constexpr unsigned kSamples = 1024;
    const struct {
        const char* name;
        ScenePtr scene;
    } scenes[] = {{"soft shadow", soft_shadow()},
                  {"caustic", caustic()},
                  {"Veach's plates", load_scene(source_file("scenes/veach.scene"))}};
    for (const auto& [name, scene] : scenes) {
        const Picture all = traced(whole_cpu(), scene, adaptive_settings({{"seed", "1"}}), kSamples),
                      some = traced(whole_cpu(), scene, adaptive_settings({{"seed", "2"}, {"adaptive", "0.05"}}), kSamples);
        const double error = std::sqrt(all.error_squared() + some.error_squared());
        std::printf("%-15s %.1f of %u samples a pixel, light %.5f instead of %.5f, %.2f standard errors\n", name,
                    some.samples(), kSamples, some.mean(), all.mean(), (some.mean() - all.mean()) / error);
        EXPECT_LE(std::fabs(some.mean() - all.mean()), 4 * error) << name;
        EXPECT_LT(some.samples(), 0.7 * kSamples) << name << ": what is saved";
        EXPECT_EQ(some.primary, uint64_t(std::llround(some.samples() * double(some.pixels())))) << name << ": its rays";
        double most = 0, least = kSamples;
        for (size_t i = 0; i < some.pixels(); ++i) most = std::max(most, some.count(i)), least = std::min(least, some.count(i));
        EXPECT_EQ(most, kSamples) << name;
        EXPECT_GE(least, 32) << name;
    }
}

// Of 1,024 pixels a lamp covers 0.3 of one, and another lamp a hundredth of another one: of that all of the first samples may
// be black.
TEST_F(Adaptive, FindsTheOnlyLitPixels) {
    const ScenePtr scene = scene_of_text(
        "camera main eye 0 0 10 target 0 0 0 fov 18.18\nbackground 0 0 0\nmaterial lamp color 0 0 0 emission 1 1 1\n"
        "polygon material lamp vertices -.7774 .7226 0  -.7226 .7226 0  -.7226 .7774 0  -.7774 .7774 0\n"
        "polygon material lamp vertices .745 -.755 0  .755 -.755 0  .755 -.745 0  .745 -.745 0\n");
    for (const char* seed : {"1", "2", "3", "4"}) {
        const Picture picture = traced(whole_cpu(), scene, adaptive_settings({{"seed", seed}, {"adaptive", "0.1"}}), 8192);
        const size_t often = 8 * 32 + 8, seldom = 23 * 32 + 23;
        EXPECT_NEAR(picture.light(often), 0.3, 0.1) << seed;
        EXPECT_NEAR(picture.light(seldom), 0.01, 0.005) << seed;
        EXPECT_EQ(picture.count(seldom), 8192) << seed;
        EXPECT_LT(picture.samples(), 2500) << seed << ": dark pixels rest in the end";
    }
}

TEST_F(Adaptive, IsTheSameHoweverItIsTraced) {
    const ScenePtr scene = caustic();
    const auto settings = [](const char* packet) {
        return adaptive_settings({{"adaptive", "0.1"}, {"packet", packet}, {"lanes", "8"}, {"sampler", "sobol"}});
    };
    const Picture one = traced(whole_cpu(), scene, settings("8x8"), 150);
    EXPECT_LT(one.samples(), 140);
    EXPECT_EQ(differing(one.sums.pixels, traced(whole_cpu(), scene, settings("16x4"), 150).sums.pixels), 0u) << "packet";
    EXPECT_EQ(differing(one.sums.pixels, traced(whole_cpu(), scene, settings("8x8"), 150, 7).sums.pixels), 0u)
        << "seven samples in a call";
    if (!why_no_parts().empty()) GTEST_SKIP() << why_no_parts();
    Team two("cpu/2");
    const Picture shared = traced(two, scene, settings("8x8"), 150);
    EXPECT_EQ(differing(one.sums.pixels, shared.sums.pixels), 0u) << "two devices";
    EXPECT_EQ(one.primary, shared.primary);
}

// From the film of any moment: it says which pixels rest.
TEST_F(Adaptive, GoesOnFromItsSums) {
    const ScenePtr scene = caustic();
    const Settings settings = adaptive_settings({{"adaptive", "0.1"}});
    const Picture whole = traced(whole_cpu(), scene, settings, 150);
    for (const unsigned at : {40u, 64u, 100u}) {
        const auto sums = std::make_shared<const FloatImage>(traced(whole_cpu(), scene, settings, at).sums);
        Team again("cpu");
        again.frames.resume(again.preparer.prepare(scene, with_optics(settings, *scene, make_view(*scene, 1)), again.progress),
                            settings, sums, at);
        again.trace(scene, settings, make_view(*scene, 1), at, 150 - at);
        EXPECT_EQ(differing(whole.sums.pixels, again.frames.read_sums().pixels), 0u) << "after " << at;
    }
}

}  // namespace
