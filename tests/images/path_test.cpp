// path_test.cpp -- the tracer `path` against closed forms, and how its noise falls.
#include <gtest/gtest.h>

#include <cmath>

#include "images/path_checks.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

// The root mean square error of the floor's pixels.
double floor_error(const char* sampler, unsigned samples, int seed) {
    const PathPicture picture =
        trace_paths(sphere_over_floor(), floor_view(), samples,
                    {{"depth", "1"}, {"strategy", "bsdf"}, {"sampler", sampler}, {"seed", std::to_string(seed)}});
    double sum = 0;
    for (size_t i = 1; i < picture.mean.pixels.size(); i += 3)
        sum += (picture.mean.pixels[i] - kFloorRadiance) * (picture.mean.pixels[i] - kFloorRadiance);
    return std::sqrt(sum / double(picture.mean.pixels.size() / 3));
}

TEST(Path, NothingIsWrongForAnySeed) {
    for (int seed = 0; seed < (quick() ? 1 : 20); ++seed)
        EXPECT_EQ(path_problems(seed), std::vector<std::string>()) << "seed " << seed;
}

// Every depth of a sphere that emits: a lamp that is seen, and one more reflection for each event.
TEST(Path, DepthCountsEvents) {
    for (const int depth : {1, 3, 5, 128}) {
        const PathPicture seen = trace_paths(hollow_sphere(0.8f, 1), inside_view(false), 64,
                                             {{"depth", std::to_string(depth)}, {"sampler", "independent"}});
        EXPECT_NEAR(seen.average(), hollow_sphere_radiance(0.8, depth), 4 * seen.average_error() + 2e-5) << depth;
        const PathPicture lit = trace_paths(hollow_sphere(0.8f, 0), inside_view(true), 64,
                                            {{"depth", std::to_string(depth)}, {"sampler", "independent"}});
        EXPECT_NEAR(lit.average(), lit_sphere_radiance(0.8, depth), 4 * lit.average_error() + 2e-5) << depth;
    }
}

// The host's own lights, for a scene without any, must not brighten what lights itself.
TEST(Path, LightsThatStandInAreLeftOutWhereSomethingEmits) {
    View view = inside_view(false);
    rt_light light = whitted_light(RT_LIGHT_POINT, {0.1f, 0.2f, 0.1f}, {5, 5, 5});
    light.flags = RT_LIGHT_STAND_IN;
    view.lights = {light};
    const Pairs settings = {{"depth", "3"}, {"sampler", "independent"}};
    const PathPicture emits = trace_paths(hollow_sphere(0.8f, 1), view, 64, settings);
    EXPECT_NEAR(emits.average(), hollow_sphere_radiance(0.8, 3), 4 * emits.average_error() + 2e-5);
    EXPECT_GT(trace_paths(hollow_sphere(0.8f, 0), view, 16, settings).average(), 1);
    Scene under_a_sky = hollow_sphere(0.8f, 0);
    under_a_sky.background = view.background = {0.1f, 0.1f, 0.1f};
    EXPECT_EQ(trace_paths(under_a_sky, view, 16, settings).average(), 0);
}

// A white sphere disappears in a white sky.
TEST(Path, Furnace) {
    View view = view_from({0, 0, 4}, {0, 0, 0}, 40);
    view.background = {1, 1, 1};
    // Rays that surfaces scatter find the same light everywhere: there is no noise.
    const PathPicture found = trace_paths(hollow_sphere(1, 0), view, 16, {{"depth", "8"}, {"strategy", "bsdf"}});
    for (const float value : found.mean.pixels) ASSERT_NEAR(value, 1, 1e-4);
    for (const char* strategy : {"nee", "mis"}) {
        const PathPicture drawn = trace_paths(hollow_sphere(1, 0), view, 64, {{"depth", "8"}, {"strategy", strategy}});
        EXPECT_NEAR(drawn.average(), 1, 2e-3) << strategy;
    }
}

TEST(Path, NoiseFallsWithTheRootOfTheSamples) {
    const double x[] = {std::log(4.0), std::log(16.0), std::log(64.0), std::log(256.0)};
    double sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0;
    for (const double log_samples : x) {
        const double y = std::log(floor_error("independent", unsigned(std::lround(std::exp(log_samples))), 5));
        sum_x += log_samples, sum_y += y, sum_xx += log_samples * log_samples, sum_xy += log_samples * y;
    }
    const double slope = (4 * sum_xy - sum_x * sum_y) / (4 * sum_xx - sum_x * sum_x);
    EXPECT_NEAR(slope, -0.5, 0.03);
}

TEST(Path, SobolHasLessNoise) {
    EXPECT_LT(floor_error("sobol", 64, 1), 0.8 * floor_error("independent", 64, 1));
    EXPECT_LT(floor_error("sobol", 256, 2), 0.5 * floor_error("independent", 256, 2));
}

TEST(Path, SeedsAreIndependent) {
    const auto picture = [](int seed) {
        return trace_paths(sphere_over_floor(), floor_view(), 64,
                           {{"depth", "1"}, {"strategy", "bsdf"}, {"seed", std::to_string(seed)}});
    };
    const PathPicture a = picture(1), b = picture(2);
    double sum = 0;
    for (size_t i = 1; i < a.mean.pixels.size(); i += 3)
        sum += (a.mean.pixels[i] - kFloorRadiance) * (b.mean.pixels[i] - kFloorRadiance);
    const double correlation = sum / double(a.mean.pixels.size() / 3) / (a.deviation() * b.deviation());
    EXPECT_LT(std::fabs(correlation), 5 / std::sqrt(4096.0));
}

// A million samples are added without drift; in the quick form, 16,384, of which a plain sum would be off by 1.5e-4, since 0.1
// is no float. PathSums has a million of the sums alone.
TEST(Path, SumsOfManySamplesAreExact) {
    View view = view_from({0, 0, 4}, {0, 0, 0}, 40);
    view.background = {0.5f, 0.1f, 1.0f / 3};
    const PathPicture picture = trace_paths(scene_of(TriangleMesh()), view, quick() ? 1 << 14 : 1 << 20, {{"size", "2x2"}});
    for (size_t i = 0; i < picture.mean.pixels.size(); ++i)
        EXPECT_NEAR(picture.mean.pixels[i] / view.background[i % 3], 1, 1e-5) << i;
    for (const float error : picture.error.pixels) EXPECT_LT(error, 1e-6f);
}

// A half-plane x > 0 that glows, seen from (0, 0, 4), 0.8 wide. Returns the mean of each column.
std::vector<double> glowing_half(const Pairs& settings, float aperture, float focus) {
    TriangleMesh mesh;
    mesh.add_quad(Vec{0, -9, 0}, {9, -9, 0}, {9, 9, 0}, {0, 9, 0});
    Scene scene = scene_of(mesh);
    scene.materials[0].values = diffuse(0, 0, 0);
    for (float& e : scene.materials[0].values.emission) e = 1;
    View view = view_from({0, 0, 4}, {0, 0, 0}, 2 * std::atan(0.1) * 180 / 3.14159265358979);
    view.background = view.ambient = {0, 0, 0};
    view.camera.aperture = aperture;
    view.camera.focus = focus;
    Pairs all = {{"size", "16x16"}, {"depth", "1"}};
    all.insert(all.end(), settings.begin(), settings.end());
    const PathPicture picture = trace_paths(scene, view, 256, all);
    std::vector<double> columns(16);
    for (size_t i = 0; i < 256; ++i) columns[i % 16] += picture.mean.pixels[3 * i + 1] / 16;
    return columns;
}

TEST(Path, PixelFilters) {
    const std::vector<double> box = glowing_half({}, 0, 0), gaussian = glowing_half({{"filter", "gaussian"}}, 0, 0);
    for (const int x : {0, 5, 6, 9, 10, 15}) EXPECT_EQ(box[x], x > 8) << x;
    EXPECT_NEAR(box[7], 0, 1e-3);
    EXPECT_NEAR(box[8], 1, 1e-3);
    // Half a pixel, one deviation, from the edge: the Gaussian's integral, cut at three deviations.
    EXPECT_NEAR(gaussian[8], (0.841345 - 0.001350) / 0.997300, 0.005);
    EXPECT_NEAR(gaussian[7], 1 - (0.841345 - 0.001350) / 0.997300, 0.005);
    EXPECT_EQ(gaussian[5], 0);
    EXPECT_EQ(gaussian[10], 1);
}

// Out of focus each point becomes a disc: here of radius 0.25 on the plane.
TEST(Path, ThinLens) {
    const std::vector<double> sharp = glowing_half({}, 0.5f, 0), blurred = glowing_half({}, 0.5f, 2);
    EXPECT_EQ(sharp[6], 0);
    EXPECT_EQ(sharp[9], 1);
    for (int x = 0; x < 16; ++x) {
        const double q = std::clamp(((x + 0.5) / 16 * 0.8 - 0.4) / 0.25, -1.0, 1.0);
        const double covered = 1 - (std::acos(q) - q * std::sqrt(1 - q * q)) / 3.14159265358979;
        EXPECT_NEAR(blurred[x], covered, 0.01) << x;
    }
}

// What the AOVs of noise show is what the film holds.
TEST(Path, StatisticsAreThoseOfTheFilm) {
    const Pairs base = {{"depth", "2"}, {"size", "16x16"}, {"sampler", "independent"}, {"strategy", "bsdf"}};
    const PathPicture picture = trace_paths(sphere_over_floor(), floor_view(), 64, base);
    Workbench& bench = Workbench::get();
    Progress progress;
    const auto shown = [&](const char* aov) {
        Pairs all = {{"tracer", "path"}, {"lanes", "4"}, {"packet", "8x8"}, {"aov", aov}};
        all.insert(all.end(), base.begin(), base.end());
        const Settings settings = make_settings(all);
        const ScenePtr scene = shared_scene(sphere_over_floor());
        bench.frames().trace(*bench.prepare(scene, settings, floor_view()), settings, floor_view(), Samples(0, 64), false,
                             progress);
        return bench.frames().read_values();
    };
    const FloatImage error = shown("error"), variance = shown("variance"), samples = shown("samples"), mis = shown("mis");
    for (size_t i = 0; i < 256; ++i) {
        ASSERT_FLOAT_EQ(error.pixels[i], picture.error.pixels[i]);
        ASSERT_NEAR(variance.pixels[i], 64 * error.pixels[i] * error.pixels[i], 1e-5);
        ASSERT_EQ(samples.pixels[i], 64);
        ASSERT_EQ(mis.pixels[i], 0);  // the strategy draws nothing
        // A sample is 0 or 1.
        const double p = picture.mean.pixels[3 * i + 1];
        ASSERT_NEAR(variance.pixels[i], p * (1 - p) * 64 / 63, 1e-4);
    }
}

// The parts of a picture, by the number of events, by how light was found, and by the first event, add up to it.
TEST(Path, PartsAddUpToThePicture) {
    View view = floor_view();
    view.camera = view_from({-3, 2, 0}, {0.5f, 0.5f, 0}, 50).camera;
    view.background = {0.2f, 0.3f, 0.4f};
    rt_light light{};
    light.position[1] = 4;
    for (float& c : light.color) c = 0.5f;
    view.lights = {light};
    Scene scene = sphere_over_floor();
    for (float& c : scene.materials[scene.spheres[0].material].values.color) c = 0.7f;
    const Pairs base = {{"depth", "3"}};
    const auto part = [&](const Pairs& more) {
        Pairs all = base;
        all.insert(all.end(), more.begin(), more.end());
        return trace_paths(scene, view, 8, all).mean;
    };
    const FloatImage whole = part({});
    const auto expect_sum = [&](const char* what, const std::vector<Pairs>& parts) {
        std::vector<double> sum(whole.pixels.size());
        for (const Pairs& pairs : parts) {
            const FloatImage one = part(pairs);
            double all = 0;
            for (size_t i = 0; i < sum.size(); ++i) sum[i] += one.pixels[i], all += one.pixels[i];
            EXPECT_GT(all, 0) << what << ": an empty part proves nothing";
        }
        double worst = 0;
        for (size_t i = 0; i < sum.size(); ++i) worst = std::max(worst, std::fabs(sum[i] - whole.pixels[i]));
        EXPECT_LT(worst, 1e-5) << what;
    };
    expect_sum("bounce", {{{"only_bounce", "0"}}, {{"only_bounce", "1"}}, {{"only_bounce", "2"}}, {{"only_bounce", "3"}}});
    expect_sum("by", {{{"only_by", "nee"}}, {{"only_by", "bsdf"}}});
    expect_sum("first", {{{"only_bounce", "0"}}, {{"only_first", "diffuse"}}});
}

}  // namespace
