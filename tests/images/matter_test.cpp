// matter_test.cpp -- what files say of matter, against closed forms: colours of vertices, and surfaces that are there in part.
#include <gtest/gtest.h>

#include <cmath>

#include "images/optics.hpp"
#include "images/path_checks.hpp"
#include "kernels/scene_features.hpp"
#include "scene/emissive.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

// A square with corners at (-1,-1) and (1,1) at a depth z.
void add_square(Scene& scene, float z, rt_u32 material) {
    TriangleMesh mesh;
    mesh.add_quad(Point{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z});
    place(scene, add_mesh(scene, mesh, material));
}

// Whitted's ambient light of 1, and for `path` a sky of 1: a diffuse surface shows its colour. The picture is the square at z =
// 0.
View even_view() {
    View view = view_from({0, 0, 5}, {0, 0, 0}, 2 * std::atan(1.0 / 5) * 180 / 3.14159265358979);
    view.background = view.ambient = {1, 1, 1};
    return view;
}

// Corners are red, green, blue and white; the material halves them.
Scene colored_square(const Affine& placed = kIdentity) {
    Scene scene;
    scene.materials.assign(1, Material{"", diffuse(0.5f, 0.5f, 0.5f)});
    add_square(scene, 0, 0);
    scene.colors = {1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1, 1, 1, 1, 1};
    scene.instances[0].world_from_object = placed;
    return scene;
}
// x, y: 0..1 from the lower left corner. The square is the triangles red, green, blue and red, blue, white.
std::array<double, 3> color_at(double x, double y) {
    if (y <= x) return {1 - x, x - y, y};
    return {1 - x, y - x, y};
}

void expect_colors(const FloatImage& image, double room) {
    for (unsigned y = 2; y < image.height; y += 5)
        for (unsigned x = 1; x < image.width; x += 5) {
            const double u = (x + 0.5) / image.width, v = 1 - (y + 0.5) / image.height;
            const std::array<double, 3> wanted = color_at(u, v);
            for (unsigned k = 0; k < 3; ++k)
                ASSERT_NEAR(image.pixels[3 * (size_t(y) * image.width + x) + k], 0.5 * wanted[k], room)
                    << x << "," << y << " " << k;
        }
}

TEST(VertexColors, AreInterpolatedAndMultiplyTheMaterial) {
    for (const char* tracer : {"iterative", "wavefront"})
        for (const std::string lanes : {"1", "8"})
            if (!few_ways() || (tracer == std::string("iterative") && lanes == "8"))
                expect_colors(trace(colored_square(), even_view(), 64, 64, 1, {{"tracer", tracer}, {"lanes", lanes}}).image,
                              1e-4);
    // Rays that the surface scatters find the sky everywhere, so only places within a pixel differ.
    expect_colors(trace_paths(colored_square(), even_view(), 16, {{"strategy", "bsdf"}}).mean, 0.006);
}

// Larger by 2 about the middle, and apart, so that the structure has an instance.
TEST(VertexColors, StayWithTheirInstance) {
    Scene scene = colored_square({2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0});
    scene.instances[0].apart = true;
    View view = view_from({0, 0, 10}, {0, 0, 0}, 2 * std::atan(1.0 / 5) * 180 / 3.14159265358979);
    view.ambient = {1, 1, 1};
    expect_colors(trace(scene, view, 64, 64, 1).image, 1e-4);
}

TEST(VertexColors, OnlyScenesThatHaveThemPayForThem) {
    Scene scene = colored_square();
    BuildScene build;
    build.attribute_triangle.resize(2);
    EXPECT_TRUE(features_of(scene, build).colors);
    scene.colors = {};
    EXPECT_FALSE(features_of(scene, build).colors);
}

// ---- surfaces that are there in part

constexpr const char* kStrategies[] = {"nee", "bsdf", "mis"};

rt_material black(float opacity, rt_u32 alpha = RT_ALPHA_BLEND) {
    rt_material m = diffuse(0, 0, 0);
    m.alpha = alpha;
    m.opacity = opacity;
    m.cutoff = 0.5f;
    return m;
}
rt_u32 add_material(Scene& scene, const rt_material& material) {
    scene.materials.push_back({"", material});
    return static_cast<rt_u32>(scene.materials.size() - 1);
}
Scene empty_scene() {
    Scene scene;
    scene.materials.assign(1, Material{"", diffuse(0.5f, 0.5f, 0.5f)});
    return scene;
}
// Squares one in front of the other, from z = 0 on. Each covers the picture.
Scene layers(unsigned count, const rt_material& material) {
    Scene scene = empty_scene();
    const rt_u32 number = add_material(scene, material);
    for (unsigned i = 0; i < count; ++i) add_square(scene, 0.002f * float(i), number);
    return scene;
}

void expect_even(const Picture& picture, double value, const std::string& what) {
    for (size_t i = 0; i < picture.image.pixels.size(); ++i)
        ASSERT_NEAR(picture.image.pixels[i], value, 1e-5) << what << " " << i;
}
void expect_mean(const PathPicture& picture, double value, const std::string& what) {
    EXPECT_NEAR(picture.average(), value, 4 * picture.average_error() + 1e-5) << what;
}

TEST(Cutouts, ABlendedSquareLetsTheRestOfTheSkyThrough) {
    for (const float opacity : {0.0f, 0.3f, 1.0f}) {
        const Scene scene = layers(1, black(opacity));
        View view = even_view();
        view.ambient = {0, 0, 0};
        expect_even(trace(scene, view, 32, 32, 2, {{"lanes", "8"}}), 1 - opacity, "8 lanes");
        if (!few_ways()) {
            expect_even(trace(scene, view, 32, 32, 2, {{"lanes", "1"}}), 1 - opacity, "1 lane");
            expect_even(trace(scene, view, 32, 32, 2, {{"tracer", "wavefront"}}), 1 - opacity, "wavefront");
        }
        for (const char* strategy : kStrategies)
            expect_mean(trace_paths(scene, view, 64, {{"strategy", strategy}, {"sampler", "independent"}}), 1 - opacity,
                        strategy);
    }
    expect_mean(trace_paths(layers(3, black(0.3f)), even_view(), 64, {{"sampler", "sobol"}}), 0.7 * 0.7 * 0.7, "three");
    expect_even(trace(layers(3, black(0.3f)), even_view(), 32, 32, 4, {{"lanes", "8"}}), 0.7 * 0.7 * 0.7, "three");
}

// What it emits, too, is there in part. No light is drawn from it, so all strategies find it by rays.
TEST(Cutouts, EmissionIsThereInPart) {
    rt_material glow = black(0.25f);
    for (float& e : glow.emission) e = 2;
    View view = even_view();
    view.ambient = {0, 0, 0};
    expect_even(trace(layers(1, glow), view, 32, 32, 2), 0.25 * 2 + 0.75, "iterative");
    for (const char* strategy : kStrategies)
        expect_mean(trace_paths(layers(1, glow), view, 64, {{"strategy", strategy}, {"sampler", "independent"}}),
                    0.25 * 2 + 0.75, strategy);
    EXPECT_EQ(count_emissive(layers(1, glow)).cut_out, 2u);
    EXPECT_EQ(count_emissive(layers(1, glow)).triangles, 0u);
}

// A floor at z = 0, seen from z = 1 between two squares above it at z = 1.5 and 2.5; the light is above them.
Scene shaded_floor(unsigned squares, float opacity) {
    Scene scene = empty_scene();
    add_square(scene, 0, 0);
    const rt_u32 number = add_material(scene, black(opacity));
    for (unsigned i = 0; i < squares; ++i) {
        add_square(scene, 1.5f + float(i), number);
        scene.instances.back().world_from_object = {9, 0, 0, 0, 0, 9, 0, 0, 0, 0, 1, 0};
    }
    return scene;
}
View floor_from_below_the_squares() {
    View view = view_from({0, 0, 1}, {0, 0, 0}, 60);
    view.background = {0, 0, 0};
    return view;
}

TEST(Cutouts, ShadowsOfBlendedSquaresAreAsDarkAsTheyAre) {
    View view = floor_from_below_the_squares();
    view.lights = {whitted_light(RT_LIGHT_POINT, {0, 0, 400}, {1, 1, 1})};
    for (const unsigned squares : {1u, 2u}) {
        const double wanted = 0.5 * std::pow(0.7, squares);
        for (const char* tracer : {"iterative", "wavefront"}) {
            const Picture picture = trace(shaded_floor(squares, 0.3f), view, 16, 16, 1, {{"tracer", tracer}});
            EXPECT_NEAR(picture.at(8, 8)[1], wanted, 1e-4) << tracer << " " << squares;
        }
        const PathPicture picture = trace_paths(shaded_floor(squares, 0.3f), view, 1, {{"depth", "1"}});
        EXPECT_NEAR(picture.mean.pixels[3 * (32 * 64 + 32) + 1], wanted, 1e-4) << squares;
    }
}

// A lamp of two triangles, which light is drawn from and which rays find: both see the same of it through a square.
TEST(Cutouts, StrategiesSeeTheSameLampThroughASquare) {
    const auto lit = [](bool covered, const char* strategy) {
        Scene scene = shaded_floor(covered ? 1 : 0, 0.4f);
        rt_material lamp = black(1, RT_ALPHA_OPAQUE);
        for (float& e : lamp.emission) e = 3;
        add_square(scene, 3, add_material(scene, lamp));
        return trace_paths(scene, floor_from_below_the_squares(), 256,
                           {{"strategy", strategy}, {"sampler", "independent"}, {"depth", "1"}, {"size", "16x16"}});
    };
    for (const char* strategy : kStrategies) {
        const PathPicture bare = lit(false, "nee"), covered = lit(true, strategy);
        EXPECT_GT(bare.average(), 0.05);
        EXPECT_NEAR(covered.average(), 0.6 * bare.average(), 4 * (covered.average_error() + 0.6 * bare.average_error()))
            << strategy;
    }
}

// A texture of two by two texels of which every other one is clear. Where its alpha is below one half there is no surface.
Scene masked_square(float cutoff) {
    rt_material m = black(1, RT_ALPHA_MASK);
    m.cutoff = cutoff;
    m.texture = 0;
    Scene scene = layers(1, m);
    scene.uvs = {0, 0, 1, 0, 1, 1, 0, 1};
    scene.textures.push_back({0, 2, 2, 0, 0, 0, 0});
    for (const uint32_t texel : {0xff0000ffu, 0x000000ffu, 0x000000ffu, 0xff0000ffu}) scene.texels.push_back(texel);
    return scene;
}

TEST(Cutouts, AMaskCutsHalfOfACheckerAway) {
    View view = even_view();
    view.ambient = {0, 0, 0};
    // Depth 1: the ray goes on as the same generation.
    const FloatImage pictures[] = {trace(masked_square(0.5f), view, 64, 64, 1).image,
                                   trace_paths(masked_square(0.5f), view, 1, {{"depth", "1"}}).mean};
    for (const FloatImage& picture : pictures) {
        size_t white = 0;
        for (size_t i = 1; i < picture.pixels.size(); i += 3) {
            ASSERT_TRUE(picture.pixels[i] == 0 || picture.pixels[i] == 1) << picture.pixels[i];
            white += picture.pixels[i] == 1;
        }
        EXPECT_NEAR(double(white) / (64 * 64), 0.5, 0.01);
        EXPECT_EQ(picture.pixels[3 * (16 * 64 + 16)], 0) << "the texel at the top left is there";
        EXPECT_EQ(picture.pixels[3 * (16 * 64 + 48)], 1);
    }
    expect_even(trace(masked_square(0), view, 16, 16, 1), 0, "all is there");
    expect_even(trace(masked_square(1.5f), view, 16, 16, 1), 1, "nothing is there");
}

TEST(Cutouts, AovsShowWhatIsBehind) {
    Scene scene = masked_square(0.5f);
    scene.uvs.resize(16);
    add_square(scene, -2, 0);
    scene.instances.back().world_from_object = {9, 0, 0, 0, 0, 9, 0, 0, 0, 0, 1, 0};
    const Picture t = trace(scene, even_view(), 64, 64, 1, {{"aov", "t"}}),
                  prim = trace(scene, even_view(), 64, 64, 1, {{"aov", "prim"}});
    const auto value = [](const Picture& p, size_t x, size_t y) { return p.image.pixels[(y * 64 + x) * p.image.channels]; };
    EXPECT_NEAR(value(t, 16, 16), 5 * std::sqrt(1 + 2 * 0.0969 * 0.0969), 1e-3);
    EXPECT_NEAR(value(t, 48, 16), 7 * std::sqrt(1 + (0.103125 * 0.103125 + 0.096875 * 0.096875)), 1e-3);
    EXPECT_LT(value(prim, 16, 16), 2);
    EXPECT_GE(value(prim, 48, 16), 2);
}

TEST(Cutouts, AlphaOfVerticesIsInterpolated) {
    Scene scene = layers(1, black(1));
    scene.colors = {1, 1, 1, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0};  // from clear on the left to opaque on the right
    View view = even_view();
    view.ambient = {0, 0, 0};
    const Picture picture = trace(scene, view, 32, 32, 2);
    for (int x = 0; x < 32; ++x) EXPECT_NEAR(picture.at(x, 9)[1], 1 - (x + 0.5) / 32, 1e-4) << x;
}

// More surfaces one behind the other than a ray may pass: it ends, and the picture says so.
TEST(Cutouts, ARayPassesManySurfacesButNotAnyNumber) {
    View view = even_view();
    view.ambient = {0, 0, 0};
    const Picture some = trace(layers(100, black(0, RT_ALPHA_MASK)), view, 8, 8, 1);
    expect_even(some, 1, "100");
    EXPECT_EQ(some.stats.dropped, 0u);
    EXPECT_EQ(trace_paths(layers(100, black(0, RT_ALPHA_MASK)), view, 1, {}).average(), 1);
    const Scene many = layers(1100, black(0, RT_ALPHA_MASK));
    EXPECT_GT(trace(many, view, 8, 8, 1).stats.dropped, 0u);
    const std::vector<std::pair<std::string, std::string>> by_path = {{"tracer", "path"}};
    EXPECT_EQ(trace(layers(100, black(0, RT_ALPHA_MASK)), view, 8, 8, 1, by_path).stats.dropped, 0u);
    const FrameStats stats = trace(many, view, 8, 8, 1, by_path).stats;
    EXPECT_EQ(stats.dropped, 64u);
    EXPECT_EQ(stats.not_finite, 0u);
}

// An edit makes a surface clear: the kernels are prepared for it.
TEST(Cutouts, AnEditOfTheViewCounts) {
    const Scene scene = layers(1, black(1, RT_ALPHA_OPAQUE));
    View view = even_view();
    view.ambient = {0, 0, 0};
    expect_even(trace(scene, view, 32, 32, 2), 0, "before");
    view.materials = {scene.materials[0].values, black(0.3f)};
    expect_even(trace(scene, view, 32, 32, 2), 0.7, "iterative");
    expect_mean(trace_paths(scene, view, 16, {{"sampler", "independent"}}), 0.7, "path");
}

TEST(Cutouts, OnlyScenesThatHaveThemPayForThem) {
    EXPECT_NE(features_of(layers(1, black(1)), {}).optics.cutouts, 0u);
    EXPECT_EQ(features_of(layers(1, black(1, RT_ALPHA_OPAQUE)), {}).optics.cutouts, 0u);
}

}  // namespace
