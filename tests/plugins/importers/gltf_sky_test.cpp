// gltf_sky_test.cpp -- the light from all around of EXT_lights_image_based.
#include <gtest/gtest.h>

#include <cmath>

#include "gltf_model.hpp"
#include "measure.hpp"

namespace clarity::test {
namespace {

using Rgba = std::array<int, 4>;

// A picture of 2 x 2 texels, the upper row first: TGA.
std::string tga(const std::array<Rgba, 4>& texels) {
    std::string out("\0\0\2\0\0\0\0\0\0\0\0\0\2\0\2\0\x20\x28", 18);
    for (const Rgba& t : texels)
        for (const int k : {2, 1, 0, 3}) out += static_cast<char>(t[static_cast<size_t>(k)]);
    return out;
}
std::string plain(const Rgba& color) {
    return tga({color, color, color, color});
}

class GltfSky : public testing::Test {
 protected:
    // Faces of pure colours: +X red, -X green, +Y blue, -Y yellow, +Z cyan, -Z magenta.
    std::vector<std::string> faces_ = {plain({255, 0, 0, 255}),   plain({0, 255, 0, 255}),   plain({0, 0, 255, 255}),
                                       plain({255, 255, 0, 255}), plain({0, 255, 255, 255}), plain({255, 0, 255, 255})};
    Scene import(const json& more = json::object(), int levels = 1) {
        Model model;
        model.positions({0, 0, 0, 1, 0, 0, 1, 1, 0});
        model.indices({0, 1, 2});
        json list = json::array();
        for (size_t i = 0; i < faces_.size(); ++i) {
            model["images"].push_back({{"uri", "data:image/png;base64," + base64(faces_[i])}});
            list.push_back(i);
        }
        json light = {{"specularImageSize", 2}, {"specularImages", json::array()}};
        for (int i = 0; i < levels; ++i) light["specularImages"].push_back(list);
        light.update(more);
        model["extensions"] = {{"EXT_lights_image_based", {{"lights", {light}}}}};
        model["scenes"][0]["extensions"] = {{"EXT_lights_image_based", {{"light", 0}}}};
        return import_file(folder_.write("a.gltf", model.text()));
    }
    // What the picture of the sky has in a direction.
    static std::array<float, 3> towards(const Scene& scene, double x, double y, double z) {
        const SkyValues& sky = scene.sky.values;
        const double length = std::sqrt(x * x + y * y + z * z), pi = std::acos(-1.0);
        const double u = 0.5 + std::atan2(z, x) / (2 * pi), v = std::acos(y / length) / pi;
        const size_t column = std::min<size_t>(sky.width - 1, size_t(u * sky.width)),
                     row = std::min<size_t>(sky.height - 1, size_t(v * sky.height)), at = 3 * (row * sky.width + column);
        return {scene.sky.texels[at], scene.sky.texels[at + 1], scene.sky.texels[at + 2]};
    }
    using Color = std::array<float, 3>;
    Scratch folder_;
};

TEST_F(GltfSky, ShowsTheFacesOfACube) {
    const Scene scene = import({{"intensity", 2.5}});
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.at(0);
    ASSERT_EQ(scene.sky.values.kind, RT_SKY_PICTURE);
    EXPECT_EQ(scene.sky.values.width, 8u);
    EXPECT_EQ(scene.sky.values.height, 4u);
    EXPECT_EQ(scene.sky.values.strength, 2.5f);
    EXPECT_EQ(towards(scene, 1, -0.1, 0.1), (Color{1, 0, 0}));
    EXPECT_EQ(towards(scene, -1, -0.1, 0.1), (Color{0, 1, 0}));
    EXPECT_EQ(towards(scene, 0.1, 1, 0.1), (Color{0, 0, 1}));
    EXPECT_EQ(towards(scene, 0.1, -1, 0.1), (Color{1, 1, 0}));
    EXPECT_EQ(towards(scene, 0.1, -0.1, 1), (Color{0, 1, 1}));
    EXPECT_EQ(towards(scene, 0.1, -0.1, -1), (Color{1, 0, 1}));
}

// As they are seen from the inside: to the right of +X is +Z, and above is +Y. A texel of this sky is 45 degrees wide.
TEST_F(GltfSky, FacesAreNotMirrored) {
    const std::string black = plain({0, 0, 0, 255});
    const Rgba n = {0, 0, 0, 255}, white = {255, 255, 255, 255};
    const std::string upper_right = tga({n, white, n, n});
    const double a = 0.6;
    const struct {
        size_t face;
        std::array<double, 3> lit, opposite;  // towards the upper right, and towards the lower left
    } rows[] = {{0, {1, a, a}, {1, -a, -a}},   {1, {-1, a, -a}, {-1, -a, a}}, {2, {-a, 1, -a}, {a, 1, a}},
                {3, {-a, -1, a}, {a, -1, -a}}, {4, {-a, a, 1}, {a, -a, 1}},   {5, {a, a, -1}, {-a, -a, -1}}};
    for (const auto& row : rows) {
        faces_.assign(6, black);
        faces_[row.face] = upper_right;
        const Scene scene = import();
        EXPECT_GT(towards(scene, row.lit[0], row.lit[1], row.lit[2])[0], 0.3f) << row.face;
        EXPECT_LT(towards(scene, row.opposite[0], row.opposite[1], row.opposite[2])[0], 0.1f) << row.face;
    }
}

// A quarter about +Y leads from +X to -Z.
TEST_F(GltfSky, Turns) {
    const double half = std::sqrt(0.5);
    const Scene scene = import({{"rotation", {0, half, 0, half}}});
    EXPECT_EQ(towards(scene, 0.1, -0.1, -1), (Color{1, 0, 0}));
    EXPECT_EQ(towards(scene, 1, -0.1, 0.1), (Color{0, 1, 1}));
    const Scene tilted = import({{"rotation", {half, 0, 0, half}}});
    EXPECT_EQ(towards(tilted, 0.1, -0.1, 1), (Color{0, 0, 1})) << "a quarter about +X leads from +Y to +Z";
}

// RGBD: colours are divided by alpha.
TEST_F(GltfSky, HasLightAboveOne) {
    faces_[0] = plain({255, 128, 0, 51});
    const std::array<float, 3> light = towards(import(), 1, -0.1, 0.1);
    EXPECT_NEAR(light[0], 5, 1e-5);
    EXPECT_NEAR(light[1], 5 * 0.2158605, 1e-4);
}

TEST_F(GltfSky, SaysWhatIsLeftOut) {
    const Scene blurred = import(json::object(), 3);
    EXPECT_EQ(blurred.sky.values.kind, RT_SKY_PICTURE);
    ASSERT_EQ(blurred.warnings.size(), 1u);
    EXPECT_NE(blurred.warnings[0].find("the blurred ones and the irradiance are left out"), std::string::npos);
    faces_.pop_back();
    const Scene five = import();
    ASSERT_EQ(five.warnings.size(), 1u);
    EXPECT_NE(five.warnings[0].find("expected at least one list of 6 images"), std::string::npos) << five.warnings[0];
    EXPECT_EQ(five.sky.values.kind, RT_NONE);
    faces_.push_back("no picture");
    const Scene broken = import();
    ASSERT_EQ(broken.warnings.size(), 1u);
    EXPECT_NE(broken.warnings[0].find("face 5"), std::string::npos) << broken.warnings[0];
    EXPECT_EQ(broken.sky.values.kind, RT_NONE);
}

}  // namespace
}  // namespace clarity::test
