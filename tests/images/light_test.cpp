// light_test.cpp -- compares background, Lambert's cosine, ambient light and shadows with formulas.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "images/optics.hpp"
#include "scene/light_kinds.hpp"
#include "support/scenes.hpp"
#include "support/scratch.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

rt_light point_light(const Point& position, float intensity) {
    rt_light light{};
    light.kind = RT_LIGHT_POINT;
    for (int k = 0; k < 3; ++k) {
        light.position[k] = position[k];
        light.color[k] = intensity;
    }
    return light;
}

rt_light directional_light(const Vec& towards, float intensity) {
    rt_light light = point_light({}, intensity);
    light.kind = RT_LIGHT_DIRECTIONAL;
    const Vec unit = normalized(towards);
    for (int k = 0; k < 3; ++k) light.position[k] = static_cast<float>(unit[k]);
    return light;
}

// A plane through the origin which faces +z, with albedo 0.5, in black surroundings.
Scene plane_scene() {
    Scene scene = scene_of(TriangleMesh());
    scene.planes.push_back({{0, 0, 1}, 0, add_material(scene, diffuse(0.5f, 0.5f, 0.5f))});
    return scene;
}

View black_view(const Point& eye, const Point& target, double fov_deg) {
    View view = view_from(eye, target, fov_deg);
    view.camera.up = {0, 1, 0};
    view.background = view.ambient = {0, 0, 0};
    return view;
}

TEST(Light, BackgroundFillsAnEmptyPicture) {
    View view = black_view({0, 0, 5}, {0, 0, 0}, 45);
    view.background = {0.25f, 0.5f, 0.75f};
    const Picture picture = trace(scene_of(TriangleMesh()), view, 37, 23, 4);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            ASSERT_EQ(picture.at(x, y), (std::array<float, 3>{0.25f, 0.5f, 0.75f})) << x << "," << y;
    EXPECT_EQ(picture.stats.primary, 37u * 23u);
    EXPECT_EQ(picture.stats.shadow, 0u);
    EXPECT_EQ(picture.stats.secondary, 0u);
}

TEST(Light, DisplayIsSrgb) {
    View view = black_view({0, 0, 5}, {0, 0, 0}, 45);
    view.background = {0.0f, 0.214041f, 1.0f};  // 0.214041 is half of the range in sRGB
    const ByteImage image =
        Workbench::get().display(shared_scene(scene_of(TriangleMesh())), make_settings({{"size", "8x8"}}), view);
    ASSERT_EQ(image.pixels.size(), 8u * 8u * 4u);
    EXPECT_EQ(image.pixels[0], 0);
    EXPECT_NEAR(image.pixels[1], 128, 1);
    EXPECT_EQ(image.pixels[2], 255);
    EXPECT_EQ(image.pixels[3], 255);
}

TEST(Light, LambertsCosineFromADirection) {
    for (const double degrees : {0.0, 30.0, 60.0, 85.0, 95.0}) {
        const double angle = degrees * 3.14159265358979 / 180;
        View view = black_view({0, 0, 3}, {0, 0, 0}, 60);
        view.lights = {directional_light({std::sin(angle), 0, std::cos(angle)}, 0.8f)};
        const double expected = 0.5 * 0.8 * std::max(0.0, std::cos(angle));
        SCOPED_TRACE(std::to_string(degrees) + " degrees");
        expect_picture(trace(plane_scene(), view, 64, 48, 1), view, [&](const Ray&) { return expected; }, 1e-5, 64 * 48);
    }
}

TEST(Light, LambertsCosineFromAPointWithoutFalloff) {
    View view = black_view({0, 0, 3}, {0, 0, 0}, 60);
    const Vec lamp{0.7, -0.4, 1.5};
    view.lights = {point_light({0.7f, -0.4f, 1.5f}, 1)};
    expect_picture(
        trace(plane_scene(), view, 64, 48, 1), view,
        [&](const Ray& line) {
            const Vec p = line.at(-line.origin[2] / line.direction[2]);
            return 0.5 * normalized(lamp - p)[2];
        },
        1e-5, 64 * 48);
}

// Each kind of lights at (0.5, 0.25, 2), shining down, against the irradiance that it gives divided by pi.
TEST(Light, OtherKindsLightAsTheirUnitsSay) {
    const Vec lamp{0.5, 0.25, 2};
    const double pi = 3.14159265358979;
    struct Case {
        rt_u32 kind, flags;
        // at: strength of a colour of 1, by the squared distance and the cosine at the light
        std::function<double(double, double)> strength;
        float range = 0;
    };
    const double outer = std::cos(25 * pi / 180), inner = std::cos(10 * pi / 180), disc = 0.25;
    const auto ramp = [&](double cosine) { return std::pow(std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0), 2); };
    const Case cases[] = {
        {RT_LIGHT_POINT, RT_LIGHT_FALLOFF, [&](double d2, double) { return 1 / (pi * d2); }},
        // KHR_lights_punctual: nothing beyond the range, which is 2.4 here.
        {RT_LIGHT_POINT, RT_LIGHT_FALLOFF,
         [&](double d2, double) { return std::max(0.0, 1 - std::pow(d2 / (2.4 * 2.4), 2)) / (pi * d2); }, 2.4f},
        {RT_LIGHT_SPOT, 0, [&](double, double cosine) { return ramp(cosine); }},
        {RT_LIGHT_SPOT, RT_LIGHT_FALLOFF, [&](double d2, double cosine) { return ramp(cosine) / (pi * d2); }},
        {RT_LIGHT_SUN, 0, [&](double, double) { return 1 / pi; }},
        {RT_LIGHT_DISC, 0, [&](double d2, double cosine) { return disc * cosine / (d2 + disc); }},
        {RT_LIGHT_DISC, RT_LIGHT_TWO_SIDED, [&](double d2, double cosine) { return disc * cosine / (d2 + disc); }},
        {RT_LIGHT_RECT, 0, [&](double d2, double cosine) { return 4 / pi * cosine / (d2 + 4 / pi); }},
        {RT_LIGHT_SPHERE, 0, [&](double d2, double) { return disc / d2; }},
    };
    for (const Case& c : cases) {
        SCOPED_TRACE(std::string(light_kinds()[c.kind].name) + ", flags " + std::to_string(c.flags));
        rt_light light = default_light(c.kind);
        light.flags = c.flags;
        for (int k = 0; k < 3; ++k) {
            light.position[k] = light_kinds()[c.kind].has_place ? static_cast<float>(lamp[k]) : float(k == 2);
            light.normal[k] = k == 2 ? -1.0f : 0.0f;
            light.v[k] = k == 1 ? -1.0f : 0.0f;  // u x v is -z
        }
        light.angle = 50;
        light.inner = 20;
        light.radius = 0.5f;
        light.range = c.range;
        ASSERT_TRUE(make_sound(light));
        View view = black_view({0, 0, 3}, {0, 0, 0}, 60);
        view.lights = {light};
        const bool is_far = !light_kinds()[c.kind].has_place;
        expect_picture(
            trace(plane_scene(), view, 64, 48, 1), view,
            [&](const Ray& line) {
                const Vec to = lamp - line.at(-line.origin[2] / line.direction[2]);
                const double cosine = is_far ? 1 : normalized(to)[2];
                return 0.5 * cosine * c.strength(dot(to, to), cosine);
            },
            1e-5, 64 * 48);
    }
}

// A file's lights give what their units say: KHR_lights_punctual's candela at 2 m above a Lambert plane of albedo 0.5, I a cos
// / (pi d^2), and lux, E a cos / pi. With Whitted's tracer and with `path`.
TEST(Light, OfGltfFilesInCandelaAndLux) {
    const auto light_of = [](const std::string& type, double intensity) {
        const Scratch folder;
        const std::string light = "{\"type\":\"" + type + "\",\"intensity\":" + std::to_string(intensity) + "}";
        const std::string path = folder.write(
            "lamp.gltf",
            "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"translation\":"
            "[0,0,2],\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}],\"extensions\":{"
            "\"KHR_lights_punctual\":{\"lights\":[" +
                light + "]}}}");
        return load_scene(path)->lights.at(0).values;
    };
    for (const char* tracer : {"iterative", "path"})
        for (const char* type : {"point", "spot", "directional"}) {
            SCOPED_TRACE(std::string(tracer) + ", " + type);
            // Samples of `path` are anywhere in their pixels, so it sees one point.
            const bool is_path = std::string(tracer) == "path";
            View view = black_view({0, 0, 1}, {0, 0, 0}, is_path ? 0.01 : 90);
            view.lights = {light_of(type, 40)};
            const bool is_far = std::string(type) == "directional", is_spot = std::string(type) == "spot";
            const double pi = std::acos(-1.0), outer = std::cos(pi / 4);
            expect_picture(
                trace(plane_scene(), view, 32, 24, 1, {{"tracer", tracer}, {"spp", "1"}}), view,
                [&](const Ray& line) {
                    const Vec p = line.at(-line.origin[2] / line.direction[2]), to = Vec{0, 0, 2} - p;
                    const double d2 = dot(to, to), cosine = is_far ? 1 : 2 / std::sqrt(d2);
                    const double ramp = is_spot ? std::pow(std::clamp((cosine - outer) / (1 - outer), 0.0, 1.0), 2) : 1;
                    return 0.5 * 40 / pi * ramp * cosine / (is_far ? 1 : d2);
                },
                2e-5, 32 * 24);
        }
}

// The side of a light that does not emit gives nothing, and a second side does.
TEST(Light, OneSideOfADiscIsDark) {
    rt_light light = default_light(RT_LIGHT_DISC);
    light.position[1] = 0, light.position[2] = 2;
    light.normal[1] = 0, light.normal[2] = 1;
    ASSERT_TRUE(make_sound(light));
    View view = black_view({0, 0, 3}, {0, 0, 0}, 60);
    for (const bool two_sided : {false, true}) {
        light.flags = two_sided ? RT_LIGHT_TWO_SIDED : 0;
        ASSERT_TRUE(make_sound(light));
        view.lights = {light};
        const float middle = trace(plane_scene(), view, 3, 3, 1).at(1, 1)[0];
        EXPECT_NEAR(middle, two_sided ? 0.5 / (4 + 1) : 0.0, 1e-5);
    }
}

TEST(Light, LightsAndAmbientAddUp) {
    View view = black_view({0, 0, 3}, {0, 0, 0}, 60);
    view.lights = {directional_light({0, 0, 1}, 0.25f), directional_light({0, 1, 1}, 0.5f), directional_light({0, 0, -1}, 9)};
    view.ambient = {0.1f, 0.2f, 0.3f};
    const double expected = 0.5 * (0.25 + 0.5 * std::sqrt(0.5) + 0.2);
    expect_picture(trace(plane_scene(), view, 16, 16, 1), view, [&](const Ray&) { return expected; }, 1e-5, 256);
}

// The Blinn-Phong highlight is strongest where the half vector is the normal: there, on a plane with a light beside the eye, it
// has its full value.
TEST(Light, HighlightAtTheMirrorPoint) {
    Scene scene = plane_scene();
    rt_material& shiny = scene.materials.back().values;
    shiny.specular[0] = shiny.specular[1] = shiny.specular[2] = 0.3f;
    shiny.shininess = 50;
    View view = black_view({0, 0, 3}, {0, 0, 0}, 60);
    view.lights = {directional_light({0, 0, 1}, 1)};
    expect_picture(
        trace(scene, view, 65, 49, 1), view,
        [](const Ray& line) {
            const Vec half = normalized(Vec{0, 0, 1} - line.direction);
            return 0.5 + 0.3 * std::pow(half[2], 50);
        },
        2e-3, 65 * 49);
}

void expect_shadow_of_a_sphere(const rt_light& light) {
    Scene scene = plane_scene();
    const Vec center{0.2, -0.1, 1};
    const double radius = 0.5;
    Sphere ball;
    ball.center = {0.2f, -0.1f, 1};
    ball.radius = 0.5f;
    ball.material = 1;
    scene.spheres.push_back(ball);
    View view = black_view({0.5f, -6, 5}, {0.3f, 0, 0}, 40);
    view.lights = {light};
    const Picture picture = trace(scene, view, 160, 120, 1);
    size_t dark = 0;
    const auto expected = [&](const Ray& line) {
        double margin = 0;
        if (hit_sphere(center, radius, line, &margin) < INFINITY || margin < 0.02) return -1.0;
        const Vec p = line.at(-line.origin[2] / line.direction[2]);
        const Vec lamp{light.position[0], light.position[1], light.position[2]};
        const Vec towards = light.kind == RT_LIGHT_POINT ? normalized(lamp - p) : lamp;
        const bool shadow = hit_sphere(center, radius, {p, towards}, &margin) < INFINITY;
        if (margin < 0.02) return -1.0;
        dark += shadow;
        return shadow ? 0.0 : 0.5 * towards[2];
    };
    expect_picture(picture, view, expected, 1e-4, 160 * 120 / 2);
    EXPECT_GT(dark, 200u) << "no shadow in the picture";
    EXPECT_GT(picture.stats.shadow, 160u * 120u / 2);

    // Without shadows the same pixels are lit.
    const Picture without = trace(scene, view, 160, 120, 1, {{"shadows", "false"}});
    EXPECT_EQ(without.stats.shadow, 0u);
    size_t brighter = 0;
    for (size_t i = 0; i < without.image.pixels.size(); ++i)
        brighter += without.image.pixels[i] > picture.image.pixels[i] + 0.01f;
    EXPECT_GT(brighter, 3 * 200u);
}

TEST(Shadow, OfASphereUnderALamp) {
    expect_shadow_of_a_sphere(point_light({-0.4f, 0.3f, 3}, 1));
}
TEST(Shadow, OfASphereInTheSun) {
    expect_shadow_of_a_sphere(directional_light({0.5, 0.3, 1}, 1));
}

// An obstacle behind the lamp, as seen from the surface, casts no shadow on it.
TEST(Shadow, NotFromBehindTheLamp) {
    Scene scene = plane_scene();
    Sphere ball;
    ball.center = {0, 0, 20};
    ball.radius = 3;
    scene.spheres.push_back(ball);
    View view = black_view({0, 0, 3}, {0, 0, 0}, 60);
    view.lights = {point_light({0, 0, 2}, 1)};
    expect_picture(
        trace(scene, view, 48, 48, 1), view,
        [](const Ray& line) { return 0.5 * normalized(Vec{0, 0, 2} - line.at(-line.origin[2] / line.direction[2]))[2]; }, 1e-5,
        48 * 48);
}

// No shadow acne: a surface does not shade itself, for every scale, place and angle.
TEST(Shadow, NoSurfaceShadowsItself) {
    for (const double scale : {1e-3, 1.0, 1e3})
        for (const double offset : {0.0, 10.0}) {
            TriangleMesh mesh = uv_sphere(1, 96, 64);
            mesh.transform(scale, {offset * scale, 0, 0});
            Scene scene = scene_of(mesh);
            scene.materials[0].values = diffuse(1, 1, 1);
            const auto s = static_cast<float>(scale), x = static_cast<float>(offset * scale);
            View view = black_view({x + 0.5f * s, 0.7f * s, 4 * s}, {x, 0, 0}, 35);
            view.lights = {directional_light({0.3, 0.5, 1}, 1)};
            const Picture with = trace(scene, view, 200, 150, 1),
                          without = trace(scene, view, 200, 150, 1, {{"shadows", "false"}});
            size_t differ = 0, lit = 0;
            for (size_t i = 0; i < with.image.pixels.size(); ++i) {
                lit += without.image.pixels[i] > 0;
                // Near the edge of its own shadow, a faceted sphere may shade its next facet.
                differ += without.image.pixels[i] > 0.03f && with.image.pixels[i] != without.image.pixels[i];
            }
            EXPECT_GT(lit, 10000u);
            EXPECT_EQ(differ, 0u) << "of " << lit << " at scale " << scale << ", offset " << offset;
        }
}

}  // namespace
