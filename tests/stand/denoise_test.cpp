// denoise_test.cpp -- the denoiser: what it must leave as it is, on films that are made up; how much of the error it takes from
// pictures of four samples; and that they are the same however they are traced.
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <random>

#include "picture/denoiser.hpp"
#include "picture/film.hpp"
#include "stand/team.hpp"
#include "support/workbench.hpp"
#include "tools/compare/picture_errors.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

constexpr unsigned kWidth = 67, kHeight = 45;  // no multiples of anything
constexpr float kSamples = 4;

struct Pixel {
    float light = 1;                 // scattered by the surface, all colours alike
    float variance = 0;              // of a sample's luminance
    float own = 0;                   // light that is not scattered
    float albedo = 0.5f, depth = 4;  // depth 0: nothing is met
    float normal[3] = {0, 0, 1};
};

// Filters a film of these pixels. Returns one colour of each.
std::vector<float> denoised(const std::function<Pixel(int x, int y)>& of) {
    const size_t pixels = kWidth * kHeight;
    std::vector<float> film(4 * (4 * pixels + FilmKernels::room(pixels)));
    for (size_t i = 0; i < pixels; ++i) {
        const Pixel p = of(int(i % kWidth), int(i / kWidth));
        const bool met = p.depth > 0;
        for (size_t c = 0; c < 3; ++c) {
            film[4 * i + c] = (p.light + p.own) * kSamples;
            film[4 * (2 * pixels + i) + c] = p.own * kSamples;
            film[4 * (3 * pixels + i) + c] = met ? p.albedo * kSamples : 0;
            film[4 * (4 * pixels + i) + c] = met ? p.normal[c] * kSamples : 0;
        }
        film[4 * i + 3] = kSamples;
        film[4 * (pixels + i) + 3] = p.variance * (kSamples - 1);
        film[4 * (2 * pixels + i) + 3] = met ? kSamples / p.depth : 0;
    }
    const std::shared_ptr<Device>& device = whole_cpu().devices.front();
    static Denoiser* const denoiser = new Denoiser(device);
    const cl::Buffer buffer(device->context(), CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, film.size() * sizeof(float),
                            film.data());
    cl::Event first, last;
    std::vector<float> read(4 * pixels), out;
    device->queue().enqueueReadBuffer(denoiser->run(buffer, kWidth, kHeight, first, last), CL_TRUE, 0,
                                      read.size() * sizeof(float), read.data());
    for (size_t i = 0; i < pixels; ++i) out.push_back(read[4 * i]);
    return out;
}

// A mean of samples that are lit with a chance of 1 : 8, and 1 on average.
Pixel seldom_lit(std::mt19937& random) {
    Pixel p;
    float sum = 0, squares = 0;
    for (int s = 0; s < int(kSamples); ++s) {
        const float sample = random() % 8 == 0 ? 8.0f : 0.0f;
        sum += sample, squares += sample * sample;
    }
    p.light = sum / kSamples;
    p.variance = (squares - sum * sum / kSamples) / (kSamples - 1);
    return p;
}

}  // namespace

TEST(Denoiser, LeavesWhatIsConstant) {
    for (const float value : denoised([](int, int) {
             Pixel p;
             p.variance = 9;
             return p;
         }))
        EXPECT_NEAR(value, 1, 2e-6);
}

// Both sides are as noisy as they differ, so that nothing but the guides keeps them apart.
TEST(Denoiser, LetsNothingThroughEdges) {
    const auto expect_sides = [](const char* what, const std::function<void(Pixel&, bool right)>& put) {
        const std::vector<float> out = denoised([&](int x, int) {
            Pixel p;
            p.light = x < 30 ? 1.0f : 3.0f;
            p.variance = 16;
            put(p, x >= 30);
            return p;
        });
        for (size_t i = 0; i < out.size(); ++i) ASSERT_NEAR(out[i], i % kWidth < 30 ? 1 : 3, 6e-6) << what << ", pixel " << i;
    };
    expect_sides("normals", [](Pixel& p, bool right) { p.normal[0] = right ? 1.0f : 0.0f, p.normal[2] = right ? 0.0f : 1.0f; });
    expect_sides("depths", [](Pixel& p, bool right) { p.depth = right ? 6.0f : 4.0f; });
    expect_sides("mirror and wall", [](Pixel& p, bool right) { p.normal[2] = right ? -1.0f : 1.0f; });
    expect_sides("textures", [](Pixel& p, bool right) { p.albedo = right ? 0.9f : 0.3f; });
    // Without an edge they mix: the test above can fail.
    const std::vector<float> mixed = denoised([](int x, int) {
        Pixel p;
        p.light = x < 30 ? 1.0f : 3.0f;
        p.variance = 16;
        return p;
    });
    EXPECT_GT(mixed[20 * kWidth + 29], 1.5f);
}

// Light without scattering is set apart: what is seen in the sky is no noise.
TEST(Denoiser, LeavesEmissionAndSky) {
    const auto own = [](int x, int y) { return float((x * 7 + y * 13) % 11); };
    const std::vector<float> out = denoised([&](int x, int y) {
        Pixel p;
        p.light = y < 20 ? 0.0f : 1.0f;
        p.depth = y < 20 ? 0.0f : 4.0f;
        p.own = own(x, y);
        p.variance = 100;
        return p;
    });
    for (int i = 0; i < int(out.size()); ++i) {
        const int y = i / int(kWidth);
        ASSERT_NEAR(out[size_t(i)], own(i % int(kWidth), y) + (y < 20 ? 0.0f : 1.0f), 5e-5) << i;
    }
}

TEST(Denoiser, TakesNoiseAwayAndLeavesNoBlackTiles) {
    std::mt19937 random(7);
    double before = 0, after = 0, mean = 0;
    std::vector<float> noisy;
    const std::vector<float> out = denoised([&](int, int) {
        const Pixel p = seldom_lit(random);
        noisy.push_back(p.light);
        return p;
    });
    const auto black = [](const std::vector<float>& values) {  // tiles of 4x4
        unsigned tiles = 0;
        for (unsigned y = 0; y + 4 <= kHeight; y += 4)
            for (unsigned x = 0; x + 4 <= kWidth; x += 4) {
                float most = 0;
                for (unsigned i = 0; i < 16; ++i) most = std::max(most, values[(y + i / 4) * kWidth + x + i % 4]);
                tiles += most < 0.3f;
            }
        return tiles;
    };
    for (size_t i = 0; i < out.size(); ++i) {
        before += std::pow(noisy[i] - 1, 2), after += std::pow(out[i] - 1, 2), mean += out[i];
        EXPECT_GT(out[i], 0.2f) << i;
    }
    mean /= double(out.size());
    std::printf("RMSE %.4f, denoised %.4f, mean %.4f\n", std::sqrt(before / double(out.size())),
                std::sqrt(after / double(out.size())), mean);
    EXPECT_LT(after, before / 100);
    EXPECT_NEAR(mean, 1, 0.08) << "the light of all pixels together: the brightest are taken for something else";
    EXPECT_EQ(black(out), 0u);
}

// A pixel that shows both sides of an edge is like none beside it. If all of its samples are black, it is not known to be dark.
TEST(Denoiser, LeavesNoBlackPixelsAtEdges) {
    std::mt19937 random(7);
    const std::vector<float> out = denoised([&](int x, int y) {
        Pixel p = seldom_lit(random);
        const bool both = x == 30 && y % 3 == 0;
        p.normal[0] = both ? 0.5f : x >= 30 ? 1.0f : 0.0f;
        p.normal[2] = both ? 0.5f : x >= 30 ? 0.0f : 1.0f;
        if (both) p.light = p.variance = 0;
        return p;
    });
    for (unsigned y = 0; y < kHeight; y += 3) EXPECT_GT(out[y * kWidth + 30], 0.2f) << y;
}

TEST(Denoiser, SpreadsNothingThatIsNoNumber) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const std::vector<float> out = denoised([](int x, int y) {
        Pixel p;
        p.variance = 4;
        if (x == 10 && y == 10) p.light = std::nanf("");
        if (x == 40 && y == 20) p.light = kInfinity;
        return p;
    });
    EXPECT_TRUE(std::isnan(out[10 * kWidth + 10])) << "it is shown as it is";
    EXPECT_TRUE(std::isinf(out[20 * kWidth + 40]));
    for (size_t i = 0; i < out.size(); ++i) {
        if (i == 10 * kWidth + 10 || i == 20 * kWidth + 40) continue;
        ASSERT_NEAR(out[i], 1, 2e-6) << i;
    }
}

namespace {

Settings denoise_settings(const std::string& samples, const std::string& denoise, const std::string& seed = "1") {
    return make_settings({{"tracer", "path"},
                          {"accel", "bvh8"},
                          {"lanes", "8"},
                          {"size", "128x96"},
                          {"depth", "6"},
                          {"seed", seed},
                          {"spp", samples},
                          {"denoise", denoise}});
}

FloatImage picture(Team& team, const ScenePtr& scene, const Settings& settings) {
    team.trace(scene, settings, make_view(*scene, 128.0f / 96), 0, unsigned(settings.spp));
    return team.frames.read_picture(settings);
}

}  // namespace

TEST(Denoise, TakesMostOfTheErrorOfFourSamples) {
    const struct {
        const char* name;
        double least;  // by which the error of four samples falls
    } scenes[] = {{"cornell", 2.3}, {"spheres_sky", 1.9}};
    const Settings off = denoise_settings("1", "off");
    for (const auto& [name, least] : scenes) {
        if (few_ways() && name != std::string("cornell")) continue;
        const ScenePtr scene = load_scene(source_file(std::string("scenes/") + name + ".scene"));
        picture(whole_cpu(), scene, denoise_settings("256", "on", "2"));
        const FloatImage reference = whole_cpu().frames.read_picture(off);
        const auto errors = [&](const char* samples) {
            const double with = rmse_of(picture(whole_cpu(), scene, denoise_settings(samples, "on")), reference);
            const double without = rmse_of(whole_cpu().frames.read_picture(off), reference);
            std::printf("%-12s %s samples: RMSE %.4f, denoised %.4f, ratio %.2f\n", name, samples, without, with,
                        without / with);
            return std::pair{without, with};
        };
        const auto few = errors("4"), more = errors("64");
        EXPECT_LT(few.second * least, few.first) << name;
        EXPECT_LT(more.second * 1.5, few.second) << name << ": what the filter takes vanishes with the noise";
        EXPECT_LT(more.second, 1.05 * more.first) << name;
    }
}

TEST(Denoise, IsTheSameHoweverItIsTraced) {
    const ScenePtr scene = load_scene(source_file("scenes/cornell.scene"));
    const Settings on = denoise_settings("4", "on"), off = denoise_settings("4", "off");
    const FloatImage one = picture(whole_cpu(), scene, on);
    const ByteImage shown = whole_cpu().frames.read_display(on), noisy = whole_cpu().frames.read_display(off);
    EXPECT_FALSE(shown.pixels == noisy.pixels) << "both of one film";
    EXPECT_TRUE(shown.pixels == whole_cpu().frames.read_display(on).pixels) << "the film was left as it is";
    EXPECT_EQ(differing(picture(whole_cpu(), scene, off).pixels, whole_cpu().frames.read_values().pixels), 0u);
    picture(whole_cpu(), scene, on);
    EXPECT_EQ(differing(whole_cpu().frames.read_values().pixels, picture(whole_cpu(), scene, off).pixels), 0u)
        << "guides change no sample";
    if (!why_no_parts().empty()) GTEST_SKIP() << why_no_parts();
    Team two("cpu/2");
    EXPECT_EQ(differing(one.pixels, picture(two, scene, on).pixels), 0u) << "two devices";
    EXPECT_TRUE(shown.pixels == two.frames.read_display(on).pixels);
    // Goes on from its sums, guides and all.
    const View view = make_view(*scene, 128.0f / 96);
    two.trace(scene, on, view, 0, 2);
    const auto sums = std::make_shared<const FloatImage>(two.frames.read_sums());
    Team again("cpu");
    again.frames.resume(again.preparer.prepare(scene, with_optics(on, *scene, view), again.progress), on, sums, 2);
    again.trace(scene, on, view, 2, 2);
    EXPECT_EQ(differing(one.pixels, again.frames.read_picture(on).pixels), 0u) << "resumed";
}

TEST(Denoise, ConcernsColoursOfPathsAlone) {
    Settings settings = denoise_settings("1", "on");
    EXPECT_TRUE(denoises(settings));
    settings.denoise = "moving";
    EXPECT_FALSE(denoises(settings)) << "the window says when something moves";
    settings.denoise = "on";
    settings.aov = "variance";
    EXPECT_FALSE(denoises(settings));
    settings.aov = "color";
    settings.tracer = "iterative";
    EXPECT_FALSE(denoises(settings));
}
