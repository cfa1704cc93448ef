// path_noise_test.cpp -- how much noise is left, by sampler and by strategy, in scenes as people have them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "images/path_checks.hpp"
#include "images/path_scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

constexpr unsigned kNoiseSamples = 64;

FloatImage picture(const Scene& scene, Pairs settings, int seed) {
    settings.insert(settings.end(), {{"lanes", "16"}, {"accel", "bvh8"}, {"seed", std::to_string(seed)}});
    return trace_paths(scene, make_view(scene, 4.0f / 3), kNoiseSamples, settings).mean;
}

// The RMSE of a picture over the pixels of a mask: two pictures with other seeds differ by twice its square. The worst 0.1 % of
// pixels are left out, else a dozen fireflies would decide.
double noise(const Scene& scene, const Pairs& settings, const std::function<bool(size_t)>& mask = {}) {
    std::vector<double> squares;
    for (const int seed : {1, 3}) {
        const FloatImage a = picture(scene, settings, seed), b = picture(scene, settings, seed + 1);
        for (size_t i = 0; i < a.pixels.size() / 3; ++i) {
            if (mask && !mask(i)) continue;
            double sum = 0;
            for (size_t c = 3 * i; c < 3 * i + 3; ++c) sum += std::pow(double(a.pixels[c]) - b.pixels[c], 2) / 6;
            squares.push_back(sum);
        }
    }
    EXPECT_GT(squares.size(), 1000u);
    std::sort(squares.begin(), squares.end());
    squares.resize(squares.size() - squares.size() / 1000);
    double sum = 0;
    for (const double s : squares) sum += s;
    return std::sqrt(sum / double(squares.size()));
}

}  // namespace

TEST(PathNoise, SobolHasFourFifthsOfIndependentOnFourOfFiveScenes) {
    const struct {
        const char* name;
        ScenePtr (*scene)();
    } scenes[] = {{"Cornell box", cornell_box},
                  {"spheres", spheres_under_sky},
                  {"Veach's plates", veach_plates},
                  {"showpiece", showpiece_under_sky},
                  {"bathroom", bathroom_under_sky}};
    int good = 0;
    for (const auto& s : scenes) {
        const ScenePtr scene = s.scene();
        if (!scene) GTEST_SKIP() << "SKIPPED: no shared models; CLARITY_SHARED names their folder";
        const auto of = [&](const char* sampler) {
            return noise(*scene, {{"size", "96x72"}, {"depth", "8"}, {"sampler", sampler}});
        };
        const double sobol = of("sobol"), independent = of("independent");
        std::printf("%-15s RMSE at %u samples: sobol %.5f, independent %.5f, ratio %.3f\n", s.name, kNoiseSamples, sobol,
                    independent, sobol / independent);
        good += sobol <= 0.8 * independent;
    }
    EXPECT_GE(good, 4);
}

// On each plate a small lamp is best drawn and a smooth plate best followed; the weights of both must not lose much to either.
TEST(PathNoise, BothStrategiesTogetherAreAtMostATenthWorseThanTheBetter) {
    const ScenePtr scene = veach_plates();
    const Pairs size = {{"size", "160x120"}, {"depth", "3"}, {"sampler", "independent"}};
    Pairs of_prims = size;
    of_prims.insert(of_prims.end(), {{"aov", "prim"}, {"lanes", "16"}, {"accel", "bvh8"}});
    const Settings settings = make_settings(of_prims);
    const FloatImage prims = Workbench::get().values(scene, settings, make_view(*scene, 4.0f / 3));
    for (int plate = 0; plate < 4; ++plate) {
        const auto of = [&](const char* strategy) {
            Pairs all = size;
            all.emplace_back("strategy", strategy);
            return noise(*scene, all, [&](size_t i) { return prims.pixels[i] == float(plate); });
        };
        const double drawn = of("nee"), found = of("bsdf"), both = of("mis");
        std::printf("plate %d: nee %.5f, bsdf %.5f, mis %.5f, ratio %.3f\n", plate, drawn, found, both,
                    both / std::min(drawn, found));
        EXPECT_LE(both, 1.1 * std::min(drawn, found)) << "plate " << plate;
    }
}
