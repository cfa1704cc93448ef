// texture_test.cpp -- textures have the right orientation on every kind of primitive that can have one. Also tests the AOVs
// that describe surfaces.
#include <gtest/gtest.h>

#include <cmath>

#include "images/optics.hpp"
#include "kernels/scene_features.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

constexpr uint32_t kRed = 0xff0000ffu, kGreen = 0xff00ff00u, kBlue = 0xffff0000u, kWhite = 0xffffffffu;

// Two by two texels, top row first: red, green / blue, white.
rt_u32 add_test_texture(Scene& scene) {
    scene.textures.push_back({static_cast<rt_u32>(scene.texels.size()), 2, 2, 0, 0, 0, 0});
    for (const uint32_t texel : {kRed, kGreen, kBlue, kWhite}) scene.texels.push_back(texel);
    return static_cast<rt_u32>(scene.textures.size() - 1);
}

Scene textured_square(const Affine& placed = kIdentity) {
    Scene scene = white_square(placed);
    scene.materials[0].values.texture = add_test_texture(scene);
    return scene;
}

void expect_texel(const std::array<float, 3>& seen, const std::array<float, 3>& wanted, const char* where) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(seen[k], wanted[k], 0.04) << where << ", channel " << k;
}

TEST(Texture, BottomLeftIsUvZero) {
    const Picture picture = trace(textured_square(), view_of_square(), 64, 64, 1);
    expect_texel(picture.at(15, 15), {1, 0, 0}, "top left");
    expect_texel(picture.at(48, 15), {0, 1, 0}, "top right");
    expect_texel(picture.at(15, 48), {0, 0, 1}, "bottom left");
    expect_texel(picture.at(48, 48), {1, 1, 1}, "bottom right");
}

TEST(Texture, IsBilinearBetweenTexels) {
    const Picture picture = trace(textured_square(), view_of_square(), 64, 64, 1);
    const std::array<float, 3> middle = picture.at(31, 15);  // half a pixel to the left of the middle, between red and green
    EXPECT_NEAR(middle[0], 0.5, 0.05);
    EXPECT_NEAR(middle[1], 0.5, 0.05);
    EXPECT_NEAR(middle[2], 0.0, 0.02);
}

TEST(Texture, RepeatsOutsideItsRange) {
    Scene scene = textured_square();
    for (float& uv : scene.uvs.own()) uv += -3;
    const Picture shifted = trace(scene, view_of_square(), 64, 64, 1),
                  plain = trace(textured_square(), view_of_square(), 64, 64, 1);
    for (size_t i = 0; i < plain.image.pixels.size(); ++i)
        ASSERT_NEAR(shifted.image.pixels[i], plain.image.pixels[i], 1e-3) << i;
}

// What a texture with wrap modes shows at (u, v), computed in doubles from its definition.
std::array<float, 3> texel(double u, double v, rt_u32 wrap_u, rt_u32 wrap_v) {
    const auto place = [](double x, rt_u32 mode) {
        if (mode == RT_WRAP_CLAMP) return std::min(std::max(x, 0.0), 1.0);
        const double within = x - std::floor(x);
        return mode == RT_WRAP_MIRROR && static_cast<long>(std::floor(x)) % 2 != 0 ? 1 - within : within;
    };
    constexpr std::array<float, 3> colors[] = {{0, 0, 1}, {1, 1, 1}, {1, 0, 0}, {0, 1, 0}};  // bottom row first
    return colors[(place(v, wrap_v) < 0.5 ? 0 : 2) + (place(u, wrap_u) < 0.5 ? 0 : 1)];
}

// The square shows five pictures along each axis, of which the one in the middle is the texture itself.
TEST(Texture, WrapsAlongEachAxisAsItSays) {
    constexpr rt_u32 modes[] = {RT_WRAP_REPEAT, RT_WRAP_CLAMP, RT_WRAP_MIRROR};
    for (const rt_u32 wrap_u : modes)
        for (const rt_u32 wrap_v : modes)
            for (const char* lanes : {"1", "8"}) {
                if (wrap_u == RT_WRAP_REPEAT && wrap_v == RT_WRAP_REPEAT) continue;  // RepeatsOutsideItsRange
                Scene scene = textured_square();
                scene.textures.front().wrap = wrap_u + RT_WRAP_ALONG_V * wrap_v;
                for (float& uv : scene.uvs.own()) uv = 5 * uv - 2;
                const Picture picture = trace(scene, view_of_square(), 100, 100, 1, {{"lanes", lanes}});
                // The middle of each texel, where the neighbours have no share.
                for (int y = 5; y < 100; y += 10)
                    for (int x = 5; x < 100; x += 10) {
                        const double u = 5 * (x + 0.5) / 100 - 2, v = 5 * (99.5 - y) / 100 - 2;
                        const std::string where = std::to_string(wrap_u) + " " + std::to_string(wrap_v) + " at " +
                                                  std::to_string(u) + " " + std::to_string(v);
                        const std::array<float, 3> seen = picture.at(x, y), wanted = texel(u, v, wrap_u, wrap_v);
                        for (int k = 0; k < 3; ++k) ASSERT_NEAR(seen[k], wanted[k], 0.15) << where << ", channel " << k;
                    }
            }
}

// Between a clamped or mirrored border and what lies beyond there is no seam, where repeating shows the other side.
TEST(Texture, IsSmoothAtBordersThatAreClampedOrMirrored) {
    for (const rt_u32 mode : {RT_WRAP_REPEAT, RT_WRAP_CLAMP, RT_WRAP_MIRROR}) {
        Scene scene = textured_square();
        scene.textures.front().wrap = mode * (1 + RT_WRAP_ALONG_V);
        for (float& uv : scene.uvs.own()) uv += 0.5f;  // the border of u is in the middle
        const std::array<float, 3> border = trace(scene, view_of_square(), 64, 64, 1).at(31, 48);
        if (mode == RT_WRAP_REPEAT)
            EXPECT_NEAR(border[0], 0.5, 0.1) << "half of it is the texel on the other side";
        else
            EXPECT_NEAR(border[0], 0, 0.1) << mode;
    }
}

// A scene whose textures all repeat has no code for the other modes.
TEST(Texture, WrapModesCostNothingWhereAllRepeat) {
    Scene scene = textured_square();
    BuildScene build;
    EXPECT_TRUE(features_of(scene, build).textures);
    EXPECT_FALSE(features_of(scene, build).wraps);
    scene.textures.front().wrap = RT_WRAP_CLAMP;
    EXPECT_TRUE(features_of(scene, build).wraps);
}

TEST(Texture, RotatesWithTheMesh) {
    // A quarter turn about the square's centre, counter-clockwise: the top right corner moves to the top left.
    const Picture picture = trace(textured_square({0, -1, 0, 2, 1, 0, 0, 0, 0, 0, 1, 0}), view_of_square(), 64, 64, 1);
    expect_texel(picture.at(15, 15), {0, 1, 0}, "top left");
    expect_texel(picture.at(48, 15), {1, 1, 1}, "top right");
    expect_texel(picture.at(15, 48), {1, 0, 0}, "bottom left");
    expect_texel(picture.at(48, 48), {0, 0, 1}, "bottom right");
}

TEST(Texture, OnInstances) {
    Scene scene = textured_square();
    Instance second = scene.instances[0];
    second.world_from_object = {0, -1, 0, 2, 1, 0, 0, 0, 0, 0, 1, -1};  // rotated, and hidden behind the first
    scene.instances.push_back(second);
    const Picture front = trace(scene, view_of_square(), 64, 64, 1);
    expect_texel(front.at(15, 48), {0, 0, 1}, "bottom left of the first");
    std::swap(scene.instances[0].world_from_object[11], scene.instances[1].world_from_object[11]);
    const Picture turned = trace(scene, view_of_square(), 64, 64, 1);
    expect_texel(turned.at(15, 48), {1, 0, 0}, "bottom left of the second");
}

TEST(Texture, UprightOnASphere) {
    Scene scene = scene_of(TriangleMesh());
    scene.materials[0].values = diffuse(1, 1, 1);
    scene.materials[0].values.texture = add_test_texture(scene);
    Sphere ball;
    ball.center = {0, 0, 0};
    ball.radius = 1;
    scene.spheres.push_back(ball);
    View view = view_from({0, 0, 6}, {0, 0, 0}, 25);
    view.ambient = {1, 1, 1};
    const Picture picture = trace(scene, view, 64, 64, 1);
    // The middle of the map is the direction +z. Its left half is to the left of it, its upper half above.
    const std::array<float, 3> above_left = picture.at(16, 16), below_right = picture.at(47, 47);
    EXPECT_GT(above_left[0], above_left[2]) << "red is at the top left";
    EXPECT_GT(above_left[0], 0.5f);
    EXPECT_GT(below_right[2], 0.2f) << "white is at the bottom right";
    EXPECT_GT(below_right[0], 0.2f);
}

FloatImage aov(const Scene& scene, const View& view, const std::string& name) {
    return Workbench::get().values(shared_scene(scene), make_settings({{"aov", name}, {"size", "64x64"}}), view);
}

TEST(Aov, UvNormalInstanceAndPrim) {
    Scene scene = textured_square();
    scene.instances.push_back(scene.instances[0]);
    scene.instances[1].world_from_object[3] = 1;  // shifted right by half its width
    scene.instances[1].world_from_object[11] = -1;
    const View view = view_of_square();
    const FloatImage uv = aov(scene, view, "uv"), normal = aov(scene, view, "normal"), instance = aov(scene, view, "instance"),
                     prim = aov(scene, view, "prim"), t = aov(scene, view, "t");
    const size_t middle = 40 * 64 + 20;
    EXPECT_NEAR(uv.pixels[3 * middle], 20.5 / 64, 1e-4);
    EXPECT_NEAR(uv.pixels[3 * middle + 1], 1 - 40.5 / 64, 1e-4);
    EXPECT_NEAR(std::fabs(normal.pixels[3 * middle + 2]), 1, 1e-5);
    EXPECT_EQ(instance.pixels[middle], 0);
    EXPECT_EQ(prim.pixels[middle], 1) << "above the diagonal: the second triangle";
    EXPECT_EQ(prim.pixels[60 * 64 + 40], 0) << "below it: the first";
    const Ray line = camera_ray(view.camera, 64, 64, 20, 40);
    EXPECT_NEAR(t.pixels[middle], -5 / line.direction[2], 1e-5);

    // If the first instance is moved away, the second becomes visible; its numbers follow those of the first.
    scene.instances[0].world_from_object[3] = 50;
    EXPECT_EQ(aov(scene, view, "instance").pixels[40 * 64 + 50], 1);
    EXPECT_GE(aov(scene, view, "prim").pixels[40 * 64 + 50], 2);
    EXPECT_EQ(aov(scene, view, "instance").pixels[40 * 64 + 5], -1);
    EXPECT_EQ(aov(scene, view, "prim").pixels[40 * 64 + 5], -1);
    EXPECT_TRUE(std::isinf(aov(scene, view, "t").pixels[40 * 64 + 5]));
}

}  // namespace
