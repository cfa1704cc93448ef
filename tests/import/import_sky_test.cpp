// import_sky_test.cpp -- the sky of a text scene comes from its file, through the import worker, as floats.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "support/scenes.hpp"
#include "support/scratch.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

// A PFM of 2 x 2, rows from the bottom: texel (x, y) from the top is (100 y + 10 x, 0.5, 2000).
std::string small_pfm() {
    std::string bytes = "PF\n2 2\n-1\n";
    for (const int y : {1, 0})
        for (const int x : {0, 1})
            for (const float value : {100.f * y + 10.f * x, .5f, 2000.f}) {
                char word[4];
                std::memcpy(word, &value, 4);
                bytes.append(word, 4);
            }
    return bytes;
}

// A Radiance picture of 1 x 1 without run lengths: mantissas and a common exponent.
std::string one_texel_hdr() {
    return std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n") + char(128) + char(64) + char(32) + char(129);
}

bool warned(const Scene& scene, const std::string& text) {
    for (const std::string& warning : scene.warnings)
        if (warning.find(text) != std::string::npos) return true;
    return false;
}

TEST(ImportSky, PictureOfFloats) {
    const Scratch folder;
    folder.write("sky.pfm", small_pfm());
    const ScenePtr scene = load_scene(folder.write("a.scene", "sky sky.pfm rotate 370 strength 2 visible false\nsphere\n"));
    const Sky& sky = scene->sky;
    EXPECT_EQ(sky.values.kind, RT_SKY_PICTURE);
    EXPECT_EQ(sky.values.width, 2u);
    EXPECT_EQ(sky.values.height, 2u);
    EXPECT_NEAR(sky.values.rotate_deg, 10, 1e-4);
    EXPECT_EQ(sky.values.strength, 2);
    EXPECT_EQ(sky.values.hidden, 1u);
    EXPECT_EQ(sky.file, "sky.pfm");
    EXPECT_EQ(sky.texels.copy(), (std::vector<float>{0, .5f, 2000, 10, .5f, 2000, 100, .5f, 2000, 110, .5f, 2000}));
    EXPECT_TRUE(scene->warnings.empty());
}

TEST(ImportSky, PictureOfRadiance) {
    const Scratch folder;
    folder.write("sky.hdr", one_texel_hdr());
    const ScenePtr scene = load_scene(folder.write("a.scene", "sky sky.hdr\nsphere\n"));
    ASSERT_EQ(scene->sky.texels.size(), 3u) << (scene->warnings.empty() ? "" : scene->warnings[0]);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(scene->sky.texels[k], 1.0 / (1 << k), 0.01);  // 128 / 256 * 2^(129 - 128)
}

TEST(ImportSky, TheFirstOfLoadedFilesCounts) {
    const Scratch folder;
    folder.write("inner.scene", "sky constant 1 2 3\nsphere\n");
    folder.write("other.scene", "sky constant 7\nsphere\n");
    const ScenePtr scene = load_scene(folder.write("a.scene", "load inner.scene\nload other.scene\n"));
    EXPECT_EQ(scene->sky.values.kind, RT_SKY_CONSTANT);
    EXPECT_EQ(scene->sky.values.color[2], 3);
    const ScenePtr outer = load_scene(folder.write("b.scene", "load inner.scene\nsky gradient zenith 5 horizon 1 ground .5\n"));
    EXPECT_EQ(outer->sky.values.kind, RT_SKY_GRADIENT);
    EXPECT_EQ(outer->sky.values.color[0], 5);
}

TEST(ImportSky, EditsOfLoadedFilesAreLeftOut) {
    const Scratch folder;
    folder.write("inner.scene", "sky constant 1 2 3\nedit sky constant strength 5\nsphere\n");
    const ScenePtr scene = load_scene(folder.write("a.scene", "load inner.scene\nedit sky constant visible false\n"));
    EXPECT_TRUE(warned(*scene, "edits of lights and sky are left out"));
    ASSERT_EQ(scene->edits.size(), 2u);
    EXPECT_EQ(scene->edits[1].key, "sky.visible");
}

TEST(ImportSky, BadPicturesAreWarnings) {
    const Scratch folder;
    const ScenePtr missing = load_scene(folder.write("a.scene", "sky gone.hdr\nsphere\n"));
    EXPECT_EQ(missing->sky.values.kind, RT_NONE);
    EXPECT_TRUE(warned(*missing, "gone.hdr"));
    folder.write("cut.pfm", small_pfm().substr(0, 30));
    const ScenePtr cut = load_scene(folder.write("b.scene", "sky cut.pfm\nsphere\n"));
    EXPECT_EQ(cut->sky.values.kind, RT_NONE);
    EXPECT_TRUE(warned(*cut, "it is cut off"));
    std::string odd = small_pfm();
    const float minus = -1;
    std::memcpy(&odd[odd.size() - 4], &minus, 4);
    folder.write("odd.pfm", odd);
    const ScenePtr repaired = load_scene(folder.write("c.scene", "sky odd.pfm\nsphere\n"));
    EXPECT_EQ(repaired->sky.values.kind, RT_SKY_PICTURE);
    EXPECT_TRUE(warned(*repaired, "1 of its numbers are negative or not finite; they count as 0"));
    const float bright = 1e16f;
    std::memcpy(&odd[odd.size() - 4], &bright, 4);
    folder.write("odd.pfm", odd);
    const ScenePtr ended = load_scene(folder.write("d.scene", "sky odd.pfm\nsphere\n"));
    EXPECT_TRUE(warned(*ended, "1 of its numbers are above 1e15, where light ends"));
    EXPECT_EQ(*std::max_element(ended->sky.texels.begin(), ended->sky.texels.end()), 1e15f);
}

TEST(ImportSky, DamagedSkiesAreRefused) {
    const Scratch folder;
    Scene scene = *load_scene(folder.write("a.scene", "sphere\n"));
    ASSERT_EQ(validate(scene), "");
    scene.sky.values.kind = 9;
    EXPECT_NE(validate(scene), "");
    scene.sky.values.kind = RT_SKY_PICTURE;
    scene.sky.values.width = scene.sky.values.height = 1;
    EXPECT_NE(validate(scene), "") << "without texels";
    scene.sky.texels = {1, 1, INFINITY};
    EXPECT_NE(validate(scene), "");
    scene.sky.texels = {1, 1, 1};
    EXPECT_EQ(validate(scene), "");
}

}  // namespace
