// densities_test.cpp -- what is drawn and what rays find speak of the same densities, and these are those of the draws.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "base/angle.hpp"
#include "launch/emitters/light_bench.hpp"
#include "support/planted_faults.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

constexpr double kFullSphere = 4 * kPi;

rt_material emitting(float radiance, rt_u32 flags = 0) {
    rt_material material = diffuse(0, 0, 0);
    for (float& channel : material.emission) channel = radiance;
    material.flags = flags;
    return material;
}

TriangleMesh square() {
    TriangleMesh mesh;
    mesh.add_quad(Vec{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1});
    return mesh;
}

Instance placed(const Affine& world_from_object, rt_u32 material = RT_NONE) {
    Instance instance;
    instance.world_from_object = world_from_object;
    instance.material = material;
    return instance;
}

void add_polygon(Scene& scene, rt_u32 material, const std::vector<float>& corners) {
    Polygon polygon;
    polygon.first_corner = rt_u32(scene.polygon_corners.size() / 3);
    polygon.corner_count = rt_u32(corners.size() / 3);
    polygon.material = material;
    scene.polygons.push_back(polygon);
    scene.polygon_corners.insert(scene.polygon_corners.end(), corners.begin(), corners.end());
}

// Everything that emits, around the origin: instances that scale, shear and mirror, an emitting sphere, a polygon, all lights.
Scene full_scene() {
    Scene scene = scene_of(square());
    const rt_u32 two = add_material(scene, emitting(2)), one = add_material(scene, emitting(3, RT_MATERIAL_ONE_SIDED));
    scene.instances.clear();
    scene.instances.push_back(placed({2, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1, 0}, two));        // above, 4 x 2
    scene.instances.push_back(placed({-1, 0.5f, 0, 0, 0, 1, 0, -3, 0, 0, 1, 0}, one));   // mirrored: faces up or down
    scene.instances.push_back(placed({0, 1, 0, 3, 1, 0, 0, 0, 0.3f, 0, 0.7f, 0}, one));  // to the right
    scene.instances.push_back(placed({0, 1, 0, 3.5f, 1, 0, 0, 0, 0, 0, 1, 0}));          // dark, behind it
    Sphere ball;
    ball.center = {-3, 0, 0};
    ball.radius = 1.2f;
    ball.material = two;
    scene.spheres.push_back(ball);
    add_polygon(scene, two, {-1, -1, -3, 1, -1, -3, 1.5f, 0.5f, -3, 0, 1.5f, -3, -1.5f, 0.5f, -3});
    return scene;
}

View full_view() {
    View view = dark_view();
    view.background = {0.2f, 0.1f, 0.05f};
    view.lights = {rect_light({0, 0, 4}, {1, 0, 0.2f}, {0.3f, 1, 0}, 2), disc_light({2, 2, 2}, {-1, -1, -1}, 0.7f, 5),
                   sphere_light({-2, 2, 2}, 0.5f, 4), sun_light({1, 2, -3}, 20, 0.5f)};
    view.lights[0].flags |= RT_LIGHT_TWO_SIDED;
    return view;
}

// Without light that has no size. Each drawn ray meets what was drawn, unless something is before it, and finds its radiance
// and its density.
class Lights : public testing::TestWithParam<bool> {
 protected:
    const bool tree = GetParam();
    LightBench bench{full_scene(), full_view(), 8, tree};
};
INSTANTIATE_TEST_SUITE_P(Picked, Lights, testing::Bool(), [](const testing::TestParamInfo<bool>& info) {
    return std::string(info.param ? "ByTree" : "ByTable");
});

TEST_P(Lights, RaysFindWhatWasDrawn) {
    size_t seen = 0, of_surfaces = 0, of_sky = 0, of_lights = 0;
    for (const LightDraw& draw : bench.draw({0.1f, 0.05f, -0.2f}, even_numbers(1 << 14, 1))) {
        if (!draw.valid || draw.occluded) continue;
        ASSERT_FALSE(draw.delta);
        if (draw.found_distance < draw.distance * 0.9999f) continue;  // an area light is before it
        ASSERT_GT(draw.pdf, 0);
        const bool rim = draw.found_distance > draw.distance * 1.001f && std::isfinite(draw.distance);
        if (rim) continue;  // counted below
        ++seen;
        of_surfaces += draw.number == 0x40000000;
        of_sky += draw.number == 0x40000001 || draw.number == 3;
        of_lights += draw.number < 3;
        ASSERT_NEAR(draw.found_pdf / draw.pdf, 1, 2e-4) << draw.number << " at " << draw.distance;
        for (int k = 0; k < 3; ++k)
            ASSERT_NEAR(draw.found[k] / draw.found_pdf, draw.light[k], 3e-4 * draw.light[k]) << draw.number;
    }
    EXPECT_GT(seen, 5000u);
    EXPECT_GT(of_surfaces, 1000u);
    EXPECT_GT(of_sky, 500u);
    EXPECT_GT(of_lights, 120u);
}

// Expects drawn directions to be distributed as the density says that rays find: Pearson's chi-square in 8 x 16 cells of equal
// solid angle, against integrals of the density, which itself integrates to the share of draws that shine. A failure is tried
// again with another seed. Returns the cells that are looked at.
int expect_distribution(LightBench& bench, const Point& at, const Vec& normal = {}) {
    for (unsigned seed = 1;; ++seed) {
        constexpr int kRows = 8, kColumns = 16;
        std::vector<double> drawn(kRows * kColumns, 0), expected(kRows * kColumns, 0);
        const auto cell = [&](const std::array<float, 3>& d) {
            const int row = std::min(kRows - 1, int((1 - d[1]) / 2 * kRows));
            const double turn = std::atan2(d[2], d[0]) / (2 * kPi) + 0.5;
            return row * kColumns + std::min(kColumns - 1, int(turn * kColumns));
        };
        const size_t draws = 1 << 16, rays = 1 << 18;
        size_t hidden = 0;
        for (const LightDraw& draw : bench.draw(at, random_numbers(draws, seed), normal)) {
            // A ray finds the nearest light only, so draws of what is behind are left out on both sides.
            const bool nearest = draw.valid && !draw.occluded && draw.found_distance >= draw.distance * 0.9999f;
            if (nearest)
                ++drawn[size_t(cell(draw.towards))];
            else
                ++hidden;
        }
        double total = 0;
        for (const LightDraw& ray : bench.find(at, even_numbers(rays, seed), normal)) {
            const double share = ray.found_pdf * kFullSphere / double(rays);
            expected[size_t(cell(ray.towards))] += share * double(draws);
            total += share;
        }
        EXPECT_NEAR(total, 1 - double(hidden) / double(draws), 5e-3);
        double chi2 = 0;
        int cells = 0;
        for (size_t i = 0; i < drawn.size(); ++i)
            if (expected[i] > 20) {
                chi2 += (drawn[i] - expected[i]) * (drawn[i] - expected[i]) / expected[i];
                ++cells;
            }
        // 4 standard deviations of a chi-square, and what the quadrature is off.
        const double most = cells + 4 * std::sqrt(2.0 * cells) + 0.1 * cells;
        if (chi2 < most || seed == 2) {
            EXPECT_LT(chi2, most) << cells << " cells, seed " << seed;
            return cells;
        }
    }
}

TEST_P(Lights, DrawsAreDistributedAsTheirDensitySays) {
    ASSERT_GT(expect_distribution(bench, {0.1f, 0.05f, -0.2f}), 100);
    if (!tree) return;
    ASSERT_GT(expect_distribution(bench, {0.1f, 0.05f, -0.2f}, normalized({0.2, 1, -0.5})), 60);
}

// Each direction to a gradient is as likely as the light that comes from there, of all channels together: what a draw brings is
// always the light of the whole sky.
TEST(Gradients, AreDrawnByTheirRadiance) {
    const auto gray = [](float value) { return std::array<float, 3>{value, value, value}; };
    struct Row {
        std::array<float, 3> zenith, horizon, ground;
        int cells;  // of 128, that are bright enough
    };
    const Row rows[] = {{{0.2f, 0.4f, 1}, {1, 0.9f, 0.8f}, {0.2f, 0.15f, 0.1f}, 128},
                        {gray(0.3f), gray(0.3f), gray(0.3f), 128},
                        {gray(1e9f), gray(0), gray(0), 64},
                        {gray(0), gray(1), gray(0), 64},
                        {gray(0), gray(0), {0, 1, 0}, 64},
                        {gray(1e-9f), gray(1), gray(5), 128}};
    for (const Row& row : rows) {
        Scene scene = empty_scene();
        SkyValues& sky = scene.sky.values;
        sky.kind = RT_SKY_GRADIENT;
        sky.strength = 3;
        std::copy_n(row.zenith.begin(), 3, sky.color);
        std::copy_n(row.horizon.begin(), 3, sky.horizon);
        std::copy_n(row.ground.begin(), 3, sky.ground);
        double flux = 0;
        for (int k = 0; k < 3; ++k)
            flux += sky.strength * kPi * (double(row.zenith[k]) + row.horizon[k] + 2 * double(row.ground[k]));
        LightBench bench(scene, dark_view());
        EXPECT_EQ(expect_distribution(bench, {0, 0, 0}), row.cells);
        for (const LightDraw& draw : bench.draw({0, 0, 0}, random_numbers(1 << 12, 3))) {
            ASSERT_TRUE(draw.valid);
            ASSERT_NEAR(length(to_vec(draw.towards)), 1, 1e-6);
            ASSERT_NEAR((double(draw.light[0]) + draw.light[1] + draw.light[2]) / flux, 1, 1e-4) << draw.towards[1];
        }
    }
}

TEST_P(Lights, AllLanesDrawTheSame) {
    const Numbers numbers = even_numbers(4096, 2);
    std::vector<LightDraw> first;
    for (const int lanes : lane_counts()) {
        if (tree && lanes != 1 && lanes != 8) continue;
        LightBench other(full_scene(), full_view(), lanes, tree);
        const std::vector<LightDraw> draws = other.draw({0.1f, 0.05f, -0.2f}, numbers);
        if (first.empty()) first = draws;
        for (size_t i = 0; i < draws.size(); ++i) {
            const auto &a = first[i], &b = draws[i];
            ASSERT_EQ(std::memcmp(&a.towards, &b.towards, sizeof a.towards), 0) << lanes << " lanes, draw " << i;
            ASSERT_EQ(std::memcmp(&a.light, &b.light, sizeof a.light), 0) << lanes << " lanes, draw " << i;
            ASSERT_EQ(a.pdf, b.pdf) << lanes << " lanes, draw " << i;
            ASSERT_EQ(a.distance, b.distance) << lanes << " lanes, draw " << i;
            ASSERT_EQ(a.found_pdf, b.found_pdf) << lanes << " lanes, draw " << i;
        }
    }
}

// Points at which a density could be infinite or no number.
TEST_P(Lights, NothingIsInfiniteNearLights) {
    const std::vector<Point> points = {{-2, 2, 2},    {-2, 2.5f, 2}, {-2, 2.500001f, 2}, {0, 0, 4},   {0, 3, 0},
                                       {-3, 1.2f, 0}, {-3, 0, 0},    {2, 2, 2},          {1, -1, -3}, {1e6f, 1e6f, -1e6f}};
    for (const Point& at : points)
        for (const LightDraw& draw : bench.draw(at, even_numbers(4096, 3))) {
            if (!draw.valid) continue;
            ASSERT_TRUE(std::isfinite(draw.pdf) && draw.pdf > 0) << at[0] << " " << at[1] << " " << at[2] << ": " << draw.pdf;
            for (int k = 0; k < 3; ++k)
                ASSERT_TRUE(std::isfinite(draw.light[k]) && draw.light[k] >= 0) << at[0] << " " << at[1];
            ASSERT_NEAR(length(to_vec(draw.towards)), 1, 1e-5);
            ASSERT_GT(draw.distance, 0);
        }
}

TEST_P(Lights, WithoutAnyNothingIsDrawn) {
    LightBench bench(empty_scene(), dark_view(), 8, tree);
    for (const LightDraw& draw : bench.draw({0, 0, 0}, even_numbers(64, 1))) {
        EXPECT_FALSE(draw.valid);
        EXPECT_EQ(draw.found[0], 0);
    }
}

// The tests of lights find faults: each is planted into the text of a kernel, and the numbers of a closed
// form go wrong by more than a test would pass. Quick tests look whether the kernels have these texts.

double light_of(const rt_light& light) {
    View view = dark_view();
    view.lights = {light};
    LightBench bench(empty_scene(), view);
    return bench.irradiance({0.5f, 0, 0}, {0, 1, 0}, even_numbers(1 << 14, 1));
}

TEST(PlantedFaults, OfLightsAreFound) {
    const rt_light square = rect_light({0, 1, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}, 1), sun = sun_light({0, 1, 0}, 0.533, 1);
    const double of_square = kPi * 0.180369;
    const auto light_with = [](const char* from, const char* to, const rt_light& light) {
        const FaultyKernel planted("shading/emitters.h", from, to);
        return quick() ? double(INFINITY) : light_of(light);
    };
    const char* const density = "return distance2 / (area * cosine);";
    EXPECT_NEAR(light_of(square) / of_square, 1, 0.005) << "sound";
    EXPECT_NEAR(light_of(sun), 1, 0.005) << "sound";
    EXPECT_GT(std::fabs(light_with(density, "return rt_vfloat(1.0f) / (area * cosine);", square) / of_square - 1), 0.02)
        << "light pdf without distance^2";
    EXPECT_GT(std::fabs(light_with(density, "return distance2 / area;", square) / of_square - 1), 0.02)
        << "light pdf without cosine";
    EXPECT_GT(std::fabs(light_with("return rt_vfloat(2.0f * RT_PI) * versine;", "return rt_vfloat(RT_PI) * versine;", sun) - 1),
              0.02)
        << "sun solid angle off by 2";
}

// A lobe towards a corner of the horizon, where both faults show.
TEST(PlantedFaults, OfSkiesAreFound) {
    Scene scene = empty_scene();
    SkyValues& sky = scene.sky.values;
    sky.kind = RT_SKY_PICTURE;
    sky.width = 32;
    sky.height = 16;
    std::vector<float> texels(3 * 32 * 16, 0.1f);
    for (int k = 0; k < 3; ++k) texels[size_t(3 * (4 * 32 + 16) + k)] = 100;
    scene.sky.texels = texels;
    // Its middle: azimuth and angle to the zenith of texel (16, 4).
    const double phi = 2 * kPi * (16.5 / 32 - 0.5), theta = kPi * 4.5 / 16;
    const Vec middle = {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
    const auto errors = [&] {
        LightBench bench(scene, dark_view());
        const double by_draws = bench.irradiance({0, 0, 0}, {0, 1, 0}, even_numbers(1 << 15, 1)),
                     by_rays = bench.irradiance_by_rays({0, 0, 0}, {0, 1, 0}, even_numbers(1 << 18, 1));
        Vec mean{};
        for (const LightDraw& ray : bench.find({0, 0, 0}, even_numbers(1 << 18, 1))) {
            const double light = std::max(0.f, ray.found[0] - 0.1f);
            mean = mean + light * to_vec(ray.towards);
        }
        return std::pair(std::fabs(by_draws / by_rays - 1), length(normalized(mean) - middle));
    };
    const auto errors_with = [&](const char* from, const char* to) {
        const FaultyKernel planted("shading/sky.h", from, to);
        return quick() ? std::pair<double, double>(INFINITY, INFINITY) : errors();
    };
    const auto [sound_light, sound_place] = errors();
    EXPECT_LT(sound_light, 0.01) << "sound";
    EXPECT_LT(sound_place, 0.01) << "sound";
    EXPECT_GT(errors_with("rt_max(sine, rt_vfloat(1e-9f))", "rt_vfloat(1.0f)").first, 0.05) << "env sin(theta) missing";
    EXPECT_GT(errors_with("x = fma(u, rt_vfloat((float)w), rt_vfloat(-0.5f))", "x = u * rt_vfloat((float)w)").second, 0.05)
        << "env shifted by half a texel";
}

// On a wall, which sees both halves of a gradient.
TEST(PlantedFaults, OfGradientsAreFound) {
    Scene scene = empty_scene();
    SkyValues& sky = scene.sky.values;
    sky.kind = RT_SKY_GRADIENT;
    for (int k = 0; k < 3; ++k) sky.color[k] = 1, sky.horizon[k] = 0.2f, sky.ground[k] = 0.4f;
    const auto error = [&] {
        LightBench bench(scene, dark_view());
        return std::fabs(bench.irradiance({0, 0, 0}, {1, 0, 0}, even_numbers(1 << 15, 1)) /
                             bench.irradiance_by_rays({0, 0, 0}, {1, 0, 0}, even_numbers(1 << 18, 1)) -
                         1);
    };
    const auto error_with = [&](const char* from, const char* to) {
        const FaultyKernel planted("shading/sky.h", from, to);
        return quick() ? double(INFINITY) : error();
    };
    EXPECT_LT(error(), 0.005) << "sound";
    EXPECT_GT(error_with("rt_vfloat(1.0f - below) * rt_gradient_shape", "rt_gradient_shape"), 0.02)
        << "density without the share of the part above";
    EXPECT_GT(error_with("fma(y, rt_vfloat(1.0f - 2.0f * horizon), rt_vfloat(horizon))",
                         "fma(y, rt_vfloat(2.0f * horizon - 1.0f), rt_vfloat(1.0f - horizon))"),
              0.02)
        << "horizon and zenith change places";
    EXPECT_GT(error_with("height = v / rt_max(", "height = v; (void)rt_max("), 0.02) << "drawn evenly above";
}

}  // namespace
