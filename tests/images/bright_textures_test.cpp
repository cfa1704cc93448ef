// bright_textures_test.cpp -- textures of light above 1: what shines has it, what reflects does not.
#include <gtest/gtest.h>

#include <cmath>

#include "base/pictures/shared_exponent.hpp"
#include "images/map_scenes.hpp"
#include "import/sink/texture.hpp"
#include "launch/emitters/sky_table.hpp"
#include "scene/bright_texture.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

uint32_t light(float r, float g, float b) {
    const float rgb[3] = {r, g, b};
    return to_shared_exponent(rgb);
}

// Both tracers of Whitted's, packets and single rays, and `path`.
std::vector<FloatImage> all_pictures(const Scene& scene) {
    std::vector<FloatImage> all = pictures(scene);
    all.push_back(trace(scene, flat_view(), 64, 64, 1, {{"lanes", "1"}, {"tracer", "wavefront"}}).image);
    return all;
}

TEST(SharedExponent, RoundsToTheNearest) {
    for (const float most : {1e-4f, 0.02f, 0.999f, 1.0f, 1.7f, 511.f, 511.6f, 65408.f})
        for (const float share : {1.0f, 0.37f, 0.004f}) {
            const float rgb[3] = {most * share, most, 0};
            const std::array<float, 3> back = from_shared_exponent(to_shared_exponent(rgb));
            const double step = std::max(std::ldexp(1.0, std::ilogb(most * 1.001f) - 8), std::ldexp(1.0, -24));
            for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(back[k], rgb[k], 0.5001 * step) << most << ", channel " << k;
        }
    const float beyond[3] = {1e9f, 0, 0};
    EXPECT_EQ(from_shared_exponent(to_shared_exponent(beyond))[0], kBrightestShared);
    EXPECT_EQ(from_shared_exponent(light(0, 0, 0)), (std::array<float, 3>{0, 0, 0}));
}

TEST(BrightTextures, ShineAsBrightAsTheyAre) {
    Scene scene = white_square();
    scene.materials[0].values = diffuse(0, 0, 0);
    for (float& channel : scene.materials[0].values.emission) channel = 0.5f;
    const std::vector<uint32_t> texels = {light(40, 0, 0), light(0, 6, 0), light(0, 0, 0.5f), light(3, 3, 3)};
    add_map(scene, 0, RT_MAP_EMISSION, add_texture(scene, 2, texels, kBrightTexture));
    for (const FloatImage& image : all_pictures(scene)) {
        expect_color(image, 15, 15, {20, 0, 0}, 0.7, "top left");
        expect_color(image, 48, 15, {0, 3, 0}, 0.7, "top right");
        expect_color(image, 15, 48, {0, 0, 0.25f}, 0.4, "bottom left");
        expect_color(image, 48, 48, {1.5f, 1.5f, 1.5f}, 0.1, "bottom right");
        const float middle = pixel(image, 31, 15)[0];  // half a pixel beside the middle
        EXPECT_NEAR(middle, 10, 0.7) << "interpolated in linear light";
    }
}

// Light of a scene that a picture's texels divide by a power of two, in kernels and in the table of lamps.
TEST(BrightTextures, ShineByTheirPowerOfTwo) {
    for (const int power : {-112, -20, 34}) {
        Scene scene =
            lamp({light(3, 3, 3), light(3, 3, 3), light(3, 3, 3), light(3, 3, 3)}, RT_TEXTURE_NEAREST | bright_flags(power));
        EXPECT_EQ(mean_of_map(scene, 0, 0), std::ldexp(3, power));
        scene = white_square();
        scene.materials[0].values = diffuse(0, 0, 0);
        for (float& channel : scene.materials[0].values.emission) channel = 1;
        add_map(scene, 0, RT_MAP_EMISSION, add_texture(scene, 1, {light(40, 5, 1)}, bright_flags(power)));
        for (const FloatImage& image : all_pictures(scene)) {
            const auto seen = pixel(image, 32, 32);
            const double wanted[3] = {40, 5, 1};
            for (size_t k = 0; k < 3; ++k)
                EXPECT_NEAR(seen[k] / std::ldexp(wanted[k], power), 1, 1e-3) << power << ", channel " << k;
        }
    }
}

TEST(BrightTextures, LightWhatIsAroundThem) {
    const Scene plain = lamp({}), bright = lamp({light(3, 3, 3), light(3, 3, 3), light(3, 3, 3), light(3, 3, 3)},
                                                RT_TEXTURE_NEAREST | kBrightTexture);
    EXPECT_NEAR(mean_of_map(bright, 0, 0), 3, 1e-6) << "by which the lamp is picked";
    const double whole = lit_floor(plain, "nee").average();
    for (const char* strategy : {"nee", "bsdf", "mis"}) {
        const PathPicture seen = lit_floor(bright, strategy);
        EXPECT_NEAR(seen.average(), 3 * whole, 4 * seen.average_error() + 0.006) << strategy;
    }
}

TEST(BrightTextures, ReflectNoMoreThanTheyGet) {
    Scene scene = white_square();
    scene.materials[0].values.texture = add_texture(scene, 1, {light(5, 0.5f, 0.25f)}, kBrightTexture);
    for (const FloatImage& image : all_pictures(scene)) expect_color(image, 30, 30, {1, 0.5f, 0.25f}, 2e-3, "reflected");
    scene.materials[0].values.model = RT_MODEL_UNLIT;
    expect_color(trace_paths(scene, flat_view(), 4, {}).mean, 30, 30, {5, 0.5f, 0.25f}, 1e-2, "unlit");
}

// A number of a surface ends at 1, and there is no alpha.
TEST(BrightTextures, HaveNumbersUpTo1) {
    const auto seen = [](uint32_t texel, rt_u32 flags) {
        Scene scene = white_square();
        MaterialValues& values = scene.materials[0].values;
        values.model = RT_MODEL_GLTF;
        values.roughness = 0.5f;
        values.alpha = RT_ALPHA_BLEND;
        values.opacity = 1;
        add_map(scene, 0, RT_MAP_METALLIC_ROUGHNESS, add_texture(scene, 1, {texel}, flags));
        scene.materials[0].values.texture = static_cast<rt_u32>(scene.textures.size() - 1);
        View view = flat_view();
        view.background = {0, 0, 0};
        view.lights = {whitted_light(RT_LIGHT_POINT, {1, 1, 2}, {2, 2, 2})};
        return pixel(trace_paths(scene, view, 4, {{"depth", "1"}, {"strategy", "nee"}}).mean, 32, 32);
    };
    const auto bright = seen(light(9, 7, 0), kBrightTexture), plain = seen(0xff00ffffu, RT_TEXTURE_LINEAR);
    for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(bright[k], plain[k], 1e-4) << k;
    EXPECT_GT(plain[0], 0.1f);
}

TEST(BrightTextures, HaveSmallerPicturesOfTheirMean) {
    std::vector<uint32_t> texels = {light(16, 0, 0), light(0, 0, 0), light(0, 0, 0), light(0, 0.5f, 0)};
    rt_texture texture = {0, 2, 2, 0, kBrightTexture, 0, 0};
    import::add_smaller_pictures(texels, texture);
    ASSERT_EQ(texels.size(), 5u);
    EXPECT_EQ(from_shared_exponent(texels[4]), (std::array<float, 3>{4, 0.125f, 0}));
}

}  // namespace
