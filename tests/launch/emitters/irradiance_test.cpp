// irradiance_test.cpp -- light on a facet against closed forms. Sources: Hottel's and Howell's form factors of discs and
// rectangles, the sphere's projected solid angle, KHR_lights_punctual.
#include <gtest/gtest.h>

#include <cmath>

#include "base/angle.hpp"
#include "launch/emitters/light_bench.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

constexpr size_t kDraws = 1 << 15;

// Expects the irradiance by drawn lights within 4 standard errors, and by rays in all directions if the light is large enough
// for them.
void expect_irradiance(const Scene& scene, const View& view, const Point& at, const Vec& normal, double wanted,
                       bool by_rays = false) {
    LightBench bench(scene, view), by_tree(scene, view, 8, true);
    for (LightBench* const each : {&by_tree, &bench}) {
        double error = 0;
        const double found = each->irradiance(at, normal, random_numbers(kDraws, 1), &error);
        EXPECT_NEAR(found / wanted, 1, 4 * error / wanted + 1e-5);
        EXPECT_LT(error / wanted, 0.01) << "too noisy to tell anything";
    }
    if (!by_rays) return;
    EXPECT_NEAR(bench.irradiance_by_rays(at, normal, even_numbers(1 << 16, 1)) / wanted, 1, 0.01);
}

View lit_by(const rt_light& light) {
    View view = dark_view();
    view.lights = {light};
    return view;
}

const Vec kUp = {0, 1, 0};

TEST(Irradiance, PointAndSpotOfGltf) {
    // 10 cd at 2 m: 2.5 lx.
    expect_irradiance(empty_scene(), lit_by(point_light({0, 2, 0}, 10)), {0, 0, 0}, kUp, 2.5);
    // With a range of 4 m: 1 - (2 / 4)^4 of it.
    rt_light near = point_light({0, 2, 0}, 10);
    near.range = 4;
    expect_irradiance(empty_scene(), lit_by(near), {0, 0, 0}, kUp, 2.5 * 15 / 16);
    near.range = 2;
    LightBench beyond(empty_scene(), lit_by(near));
    EXPECT_EQ(beyond.irradiance({0, 0, 0}, kUp, even_numbers(64, 1)), 0);
    const Point at_30 = {float(2 * std::tan(kPi / 6)), 0, 0};
    for (const double inner : {0.0, 20.0}) {
        const rt_light spot = spot_light({0, 2, 0}, {0, -1, 0}, 10, inner, 45);
        const double ramp = (std::cos(kPi / 6) - std::cos(kPi / 4)) / (std::cos(inner * kPi / 180) - std::cos(kPi / 4)),
                     distance = 2 / std::cos(kPi / 6);
        expect_irradiance(empty_scene(), lit_by(spot), {0, 0, 0}, kUp, 2.5);
        expect_irradiance(empty_scene(), lit_by(spot), at_30, kUp,
                          10 * ramp * ramp / (distance * distance) * std::cos(kPi / 6));
    }
    LightBench dark(empty_scene(), lit_by(spot_light({0, 2, 0}, {0, -1, 0}, 10, 0, 29)));
    EXPECT_EQ(dark.irradiance(at_30, kUp, even_numbers(64, 1)), 0);
    // 3 lx at 60 degrees.
    expect_irradiance(empty_scene(), lit_by(far_light({float(std::sqrt(0.75)), 0.5f, 0}, 3)), {0, 0, 0}, kUp, 1.5);
}

TEST(Irradiance, LightsWithoutFalloffMeanPiTimesTheirColor) {
    for (const rt_u32 kind : {RT_LIGHT_POINT, RT_LIGHT_DIRECTIONAL}) {
        rt_light light = whitted_light(kind, kind == RT_LIGHT_POINT ? Point{0, 7, 0} : Point{0, 1, 0}, {0.5f, 0.5f, 0.5f});
        expect_irradiance(empty_scene(), lit_by(light), {0, 0, 0}, kUp, kPi * 0.5);
    }
}

// Truth, section 4: a unit square above a floor. As a light, as two triangles, as a polygon, as an instance that is scaled.
TEST(Irradiance, UnitSquareAboveAFloor) {
    struct Row {
        Point at;
        double wanted;
    };
    const std::vector<Row> rows = {{{0, 0, 0}, 0.239456}, {{0.5f, 0, 0}, 0.180369}, {{0.5f, 0, 0.5f}, 0.138532}};
    rt_material one = diffuse(0, 0, 0);
    one.emission[0] = 1;
    one.flags = RT_MATERIAL_ONE_SIDED;
    TriangleMesh mesh;  // half as large, twice as long; seen from below it goes around counter-clockwise
    mesh.add_quad(Vec{-1, 0, -0.25}, {1, 0, -0.25}, {1, 0, 0.25}, {-1, 0, 0.25});
    Scene two_instances = scene_of(mesh);
    const rt_u32 material = add_material(two_instances, one);
    two_instances.instances[0].world_from_object = {0.5f, 0, 0, 0, 0, 3, 0, 1, 0, 0, 2, 0};
    two_instances.instances[0].material = material;
    Scene flat = two_instances;
    Instance dark;
    dark.world_from_object = {1, 0, 0, 0, 0, 1, 0, -5, 0, 0, 1, 0};
    two_instances.instances.push_back(dark);
    Scene mirrored = two_instances;  // in itself, so that its normal stays where it is
    for (const int i : {0, 1, 2}) mirrored.instances[0].world_from_object[size_t(4 * i)] *= -1;
    Scene with_polygon = empty_scene();
    Polygon polygon;
    polygon.corner_count = 4;
    polygon.material = add_material(with_polygon, one);
    with_polygon.polygons = {polygon};
    with_polygon.polygon_corners = {-0.5f, 1, -0.5f, 0.5f, 1, -0.5f, 0.5f, 1, 0.5f, -0.5f, 1, 0.5f};
    const View light = lit_by(rect_light({0, 1, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}, 1));
    for (const Row& row : rows) {
        expect_irradiance(empty_scene(), light, row.at, kUp, kPi * row.wanted, true);
        expect_irradiance(flat, dark_view(), row.at, kUp, kPi * row.wanted, true);
        expect_irradiance(two_instances, dark_view(), row.at, kUp, kPi * row.wanted, true);
        expect_irradiance(mirrored, dark_view(), row.at, kUp, kPi * row.wanted, true);
        expect_irradiance(with_polygon, dark_view(), row.at, kUp, kPi * row.wanted, true);
    }
    // Nothing goes to the other side, unless both sides emit.
    Scene turned = two_instances;
    turned.materials[material].values.flags = 0;
    expect_irradiance(turned, dark_view(), {0, 2, 0}, {0, -1, 0}, kPi * 0.239456, true);
    LightBench above(two_instances, dark_view());
    EXPECT_EQ(above.irradiance({0, 2, 0}, {0, -1, 0}, even_numbers(1024, 1)), 0);
    EXPECT_EQ(above.irradiance_by_rays({0, 2, 0}, {0, -1, 0}, even_numbers(1024, 1)), 0);
}

TEST(Irradiance, DiscOnItsAxis) {
    for (const double height : {0.2, 1.0, 30.0})
        expect_irradiance(empty_scene(), lit_by(disc_light({0, float(height), 0}, {0, -1, 0}, 0.5f, 3)), {0, 0, 0}, kUp,
                          kPi * 3 * 0.25 / (0.25 + height * height));
}

// Truth, section 3: a Lambert sphere of albedo 0.5 and radius 1 under a sphere of radius 0.5 and radiance 10 at (0, 3, 0).
TEST(Irradiance, SphereUnderASphere) {
    const std::vector<std::pair<double, double>> rows = {{0, 0.312500},  {15, 0.275164}, {30, 0.189725}, {45, 0.101462},
                                                         {60, 0.033747}, {65, 0.017472}, {70, 0.006727}};
    Scene emitting = empty_scene();
    rt_material ten = diffuse(0, 0, 0);
    ten.emission[0] = 10;
    Sphere ball;
    ball.center = {0, 3, 0};
    ball.radius = 0.5f;
    ball.material = add_material(emitting, ten);
    emitting.spheres = {ball};
    for (const auto& [phi, radiance] : rows) {
        const double angle = phi * kPi / 180;
        const Vec normal = {std::sin(angle), std::cos(angle), 0};
        for (const Scene& scene : {empty_scene(), emitting}) {
            const View view = scene.spheres.empty() ? lit_by(sphere_light({0, 3, 0}, 0.5f, 10)) : dark_view();
            expect_irradiance(scene, view, to_floats(normal), normal, radiance * kPi / 0.5);
        }
    }
    // From within an emitting sphere: pi times the radiance, wherever and whichever way. Also on its surface.
    for (const float x : {0.0f, 0.3f, 0.4999f, 0.4999995f})
        expect_irradiance(emitting, dark_view(), {x, 3, 0}, {-1, 0, 0}, kPi * 10, true);
}

TEST(Irradiance, Skies) {
    View view = dark_view();
    view.background = {1, 1, 1};
    expect_irradiance(empty_scene(), view, {0, 0, 0}, kUp, kPi, true);
}

// Truth, section 5: L = a + b sin(elevation) gives a + 2 b / 3.
TEST(Irradiance, GradientSky) {
    Scene scene = empty_scene();
    scene.sky.values.kind = RT_SKY_GRADIENT;
    scene.sky.values.strength = 2;
    for (int k = 0; k < 3; ++k)
        scene.sky.values.color[k] = 0.5f, scene.sky.values.horizon[k] = 0.1f, scene.sky.values.ground[k] = 0.3f;
    expect_irradiance(scene, dark_view(), {0, 0, 0}, kUp, kPi * 0.733333, true);
    expect_irradiance(scene, dark_view(), {0, 0, 0}, {0, -1, 0}, kPi * 0.6, true);
}

// A picture of the lobe max(d.s, 0)^n, s at an angle from the zenith, towards +Z at first.
Scene lobe_sky(double degrees, double n, rt_u32 width, rt_u32 height) {
    Scene scene = empty_scene();
    SkyValues& sky = scene.sky.values;
    sky.kind = RT_SKY_PICTURE;
    sky.width = width;
    sky.height = height;
    std::vector<float> texels;
    for (rt_u32 y = 0; y < height; ++y)
        for (rt_u32 x = 0; x < width; ++x) {
            const double theta = kPi * (y + 0.5) / height, phi = 2 * kPi * ((x + 0.5) / width - 0.5), t = degrees * kPi / 180;
            const double cosine = std::cos(theta) * std::cos(t) + std::sin(theta) * std::sin(phi) * std::sin(t);
            for (int k = 0; k < 3; ++k) texels.push_back(static_cast<float>(std::pow(std::max(cosine, 0.0), n)));
        }
    scene.sky.texels = std::move(texels);
    return scene;
}

// The radiance that a horizontal white Lambert surface sends, from truth, section 5. Rows h apart, joined by straight lines,
// hold h^2 / 12 times the second derivative more than the lobe; around a pole that does not cancel, and makes a share of n h^2
// / 12.
TEST(Irradiance, PictureOfALobe) {
    struct Row {
        double n, degrees, wanted;
    };
    const std::vector<Row> rows = {{1, 0, 0.666667},   {1, 60, 0.405999},  {20, 0, 0.090909},   {20, 30, 0.078730},
                                   {20, 60, 0.045501}, {500, 0, 0.003984}, {500, 60, 0.001992}, {500, 80, 0.000692}};
    for (const Row& row : rows) {
        Scene scene = lobe_sky(row.degrees, row.n, 512, 256);
        LightBench bench(scene, dark_view());
        double error = 0;
        const double found = bench.irradiance({0, 0, 0}, kUp, random_numbers(kDraws, 1), &error) / (kPi * row.wanted);
        error /= kPi * row.wanted;
        const double at_pole = row.degrees == 0 ? row.n * std::pow(kPi / 256, 2) / 12 : 0;
        EXPECT_NEAR(found, 1, 4 * error + 0.0005 + 0.5e-6 / row.wanted + at_pole) << "n " << row.n << ", " << row.degrees;
        EXPECT_LT(error, 0.01) << "the picture is not sampled by its light";
    }
}

// Which way a picture is turned: the brightest direction is +Z without rotation, and +X after a quarter (counter-clockwise from
// above: Z goes to X).
TEST(Irradiance, PictureTurnsAboutTheZenith) {
    Scene scene = lobe_sky(90, 500, 128, 64);
    const Vec directions[] = {{0, 0, 1}, {1, 0, 0}, {0, 0, -1}, {-1, 0, 0}};
    for (int quarter = 0; quarter < 4; ++quarter) {
        scene.sky.values.rotate_deg = 90.0f * static_cast<float>(quarter);
        Vec mean{};
        LightBench bench(scene, dark_view());
        for (const LightDraw& draw : bench.draw({0, 0, 0}, even_numbers(4096, 1))) mean = mean + to_vec(draw.towards);
        EXPECT_GT(dot(normalized(mean), directions[quarter]), 0.999) << quarter;
    }
}

// Texels are halves of 11 digits. Of a picture that is too bright or too dark for them all are divided by a power of two.
TEST(Irradiance, PictureIsRoundedToHalves) {
    for (const float brightest : {1e-30f, 1e-6f, 6e-5f, 0.1f, 1000.3f, 65504.0f, 65536.0f, 1e6f, 3e9f, 1e15f, 1e30f}) {
        Scene scene = empty_scene();
        SkyValues& sky = scene.sky.values;
        sky.kind = RT_SKY_PICTURE;
        sky.width = 64;
        sky.height = 32;
        std::vector<float> texels(3 * 64 * 32, brightest);
        for (size_t i = 0; i < texels.size(); i += 3) texels[i] = brightest * 1e-5f;
        scene.sky.texels = texels;
        LightBench bench(scene, dark_view());
        for (const LightDraw& ray : bench.find({0, 0, 0}, even_numbers(64, 1))) {
            EXPECT_NEAR(ray.found[1] / brightest, 1, std::ldexp(1, -11)) << brightest;
            EXPECT_NEAR(ray.found[0] / (brightest * 1e-5), 1, std::ldexp(1, -10)) << brightest;
        }
    }
}

// Between middles of texels the radiance is bilinear, across the seam at u = 0 too; beyond the last rows it is that of the
// rows.
TEST(Irradiance, PictureIsBilinear) {
    Scene scene = empty_scene();
    SkyValues& sky = scene.sky.values;
    sky.kind = RT_SKY_PICTURE;
    sky.width = 8;
    sky.height = 4;
    std::vector<float> texels;
    for (rt_u32 i = 0; i < 32; ++i)
        for (int k = 0; k < 3; ++k) texels.push_back(float((i * 7) % 13));
    scene.sky.texels = texels;
    LightBench bench(scene, dark_view());
    for (const LightDraw& ray : bench.find({0, 0, 0}, even_numbers(4096, 1))) {
        const double u = 0.5 + std::atan2(ray.towards[2], ray.towards[0]) / (2 * kPi), v = std::acos(ray.towards[1]) / kPi;
        const double x = u * 8 - 0.5, y = std::min(std::max(v * 4 - 0.5, 0.0), 3.0);
        const auto texel = [&](int column, int row) { return texels[size_t(3 * ((column + 8) % 8 + 8 * std::min(row, 3)))]; };
        const int column = int(std::floor(x)), row = int(std::floor(y));
        const double fx = x - column, fy = y - row;
        const double wanted = (1 - fy) * ((1 - fx) * texel(column, row) + fx * texel(column + 1, row)) +
                              fy * ((1 - fx) * texel(column, row + 1) + fx * texel(column + 1, row + 1));
        ASSERT_NEAR(ray.found[0], wanted, 2e-4) << u << " " << v;
    }
}

// Truth, section 6: 0.533 degrees, irradiance 1.
TEST(Irradiance, Sun) {
    const View view = lit_by(sun_light({0, 1, 0}, 0.533, 1));
    for (const double degrees : {0.0, 30.0, 60.0}) {
        const double angle = degrees * kPi / 180;
        expect_irradiance(empty_scene(), view, {0, 0, 0}, {std::sin(angle), std::cos(angle), 0}, std::cos(angle));
    }
    LightBench bench(empty_scene(), view);
    for (const LightDraw& draw : bench.draw({0, 0, 0}, even_numbers(1024, 1))) {
        ASSERT_NEAR(draw.found[0] / 14713.10, 1, 1e-4);
        ASSERT_NEAR(draw.pdf * 6.7967e-05, 1, 1e-4);
    }
    // Half of a sun that is setting is below the horizon: 2 / (3 pi) sin a times its irradiance (the mean of the height over
    // half of a small disc is 4 / (3 pi) of its radius).
    const double a = 0.533 / 2 * kPi / 180;
    expect_irradiance(empty_scene(), lit_by(sun_light({1, 0, 0}, 0.533, 1)), {0, 0, 0}, kUp, 2 / (3 * kPi) * std::sin(a));
    // No angle: as a directional light.
    expect_irradiance(empty_scene(), lit_by(sun_light({0, 1, 0}, 0, 2)), {0, 0, 0}, kUp, 2);
}

// An emitting sphere of 262,144 triangles on a facet, truth: 0.189725 within 0.1 %. Most renderers lose some of it, for lack of
// digits in their tables.
TEST(Irradiance, SphereOfAQuarterOfAMillionTriangles) {
    TriangleMesh mesh = uv_sphere(0.5, 512, 257);
    mesh.transform(1, {0, 3, 0});
    Scene scene = scene_of(mesh);
    ASSERT_EQ(scene.triangle_count(), 262144u);
    scene.materials[0].values = diffuse(0, 0, 0);
    scene.materials[0].values.emission[0] = 10;
    const double angle = kPi / 6;
    const Vec normal = {std::sin(angle), std::cos(angle), 0};
    LightBench bench(scene, dark_view());
    EXPECT_NEAR(bench.irradiance(to_floats(normal), normal, even_numbers(1 << 20, 1)) / (0.189725 * kPi / 0.5), 1, 0.001);
}

}  // namespace
