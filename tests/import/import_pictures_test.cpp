// import_pictures_test.cpp -- pictures of surfaces: large ones in small files, through the import worker, and those of floats.
#include <gtest/gtest.h>

#include <cmath>

#include "base/files/read_file.hpp"
#include "base/pictures/image_io.hpp"
#include "base/pictures/shared_exponent.hpp"
#include "import/sink/texture.hpp"
#include "scene/bright_texture.hpp"
#include "support/scenes.hpp"
#include "support/scratch.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

// A TGA of 4096 x 4096 texels of one colour, in runs of 128: 0.6 MB.
std::string large_tga(char blue) {
    std::string bytes(18, '\0');
    bytes[2] = 10;  // run lengths, true colour
    bytes[13] = bytes[15] = 0x10;
    bytes[16] = 24;
    for (int run = 0; run < 4096 * 4096 / 128; ++run) bytes += {char(0xff), blue, char(0x20), char(0x40)};
    return bytes;
}

// The texels of six such pictures are 384 MiB, with their smaller pictures 512 MiB. A worker that may take 1 GiB of addresses,
// as one of a small scene, cannot hold them while their array grows.
TEST(ImportPictures, LargeOnesInSmallFiles) {
    constexpr int kPictures = 6;
    const Scratch folder;
    std::string text;
    for (int i = 0; i < kPictures; ++i) {
        const std::string number = std::to_string(i);
        folder.write("p" + number + ".tga", large_tga(static_cast<char>(i)));
        text += "texture t" + number + " p" + number + ".tga\nmaterial m" + number + " color_map t" + number + "\n";
    }
    const ScenePtr scene = load_scene(folder.write("a.scene", text + "sphere\n"));
    EXPECT_TRUE(scene->warnings.empty()) << scene->warnings.front();
    ASSERT_EQ(scene->textures.size(), size_t(kPictures));
    uint64_t texels = 0;
    for (const rt_texture& texture : scene->textures) texels += uint64_t(texture.width) * texture.height;
    EXPECT_EQ(texels, uint64_t(kPictures) << 24);
    EXPECT_LE(double(scene->texels.size()), 1.4 * double(texels)) << "that is what `texture_bytes` of --stats counts";
    EXPECT_EQ(scene->texels[scene->textures[5].first] & 0xff0000u, 0x050000u);
}

// Decoders of Debian 12 and 13 (stb_image 2.27 and 2.30) give the same bytes: a scene looks the same on both.
TEST(ImportPictures, AreDecodedToTheSameBytesOnEverySystem) {
    const std::pair<const char*, uint64_t> pictures[] = {
        {"scenes/kaykit_dungeon/dungeon_texture.png", 0x2ffb038793a10ab5},  // four channels
        {"scenes/textures/grid.png", 0xb0190918f459d625},
        {"docs/images/light_materials.jpg", 0x7bf469f2cbbfb4f2},
        {"docs/images/light_strategies.jpg", 0x0b443fc828045be2},  // grey
    };
    for (const auto& [name, digest] : pictures) {
        const std::string bytes = read_file(source_file(name), 1 << 20, Exit::failed);
        std::vector<uint32_t> texels;
        rt_texture texture{};
        std::string lost;
        ASSERT_FALSE(
            import::decode_texture(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), texels, texture, lost))
            << name;
        uint64_t fnv = 0xcbf29ce484222325;  // FNV-1a of red, green, blue, alpha of each texel
        for (size_t i = 0; i < size_t(texture.width) * texture.height; ++i)
            for (int k = 0; k < 32; k += 8) fnv = (fnv ^ (texels[i] >> k & 255)) * 0x100000001b3;
        EXPECT_EQ(fnv, digest) << name;
    }
}

// ---- pictures of floats: a texel of 4 and three of 0.5

const std::string kHdr = std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n") + "\x80\x80\x80\x83" +
                         std::string("\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80", 12);

FloatImage bright_picture() {
    FloatImage image{2, 2, 3, {}};
    image.pixels = {4, 4, 4, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f};
    return image;
}

ScenePtr scene_with(const Scratch& folder, const std::string& file, const std::string& material) {
    static int number = 0;  // load_scene() keeps what it has read
    return load_scene(folder.write(std::to_string(number++) + ".scene",
                                   "texture t " + file + "\nmaterial m " + material + "\nsphere material m\n"));
}

TEST(ImportPictures, OfFloatsKeepTheLightOfWhatShines) {
    const Scratch folder;
    folder.write("a.hdr", kHdr);
    for (const char* file : {"a.pfm", "a.exr"}) write_image(folder.path(file), bright_picture(), {});
    for (const char* file : {"a.hdr", "a.pfm", "a.exr"}) {
        const ScenePtr scene = scene_with(folder, file, "emission_map t");
        EXPECT_TRUE(scene->warnings.empty()) << scene->warnings[0];
        ASSERT_EQ(scene->textures.size(), 1u);
        EXPECT_EQ(scene->textures[0].flags, kBrightTexture);
        ASSERT_EQ(scene->texels.size(), 5u) << "four bytes a texel, as others have";
        EXPECT_EQ(from_shared_exponent(scene->texels[0])[0], 4) << file;
        EXPECT_EQ(from_shared_exponent(scene->texels[3])[2], 0.5f) << file;
        EXPECT_NEAR(from_shared_exponent(scene->texels[4])[1], 1.375, 0.002) << "the smaller picture of " << file;
        const ScenePtr sky = load_scene(folder.write(std::string(file) + ".scene", "sky " + std::string(file) + "\nsphere\n"));
        EXPECT_TRUE(sky->warnings.empty());
    }
}

// However dark or bright the whole picture is.
TEST(ImportPictures, OfFloatsKeepTheirDigits) {
    const Scratch folder;
    for (const float scale : {1e-30f, 1e-6f, 1e-3f, 1e5f, 1e14f}) {
        FloatImage image = bright_picture();
        for (float& number : image.pixels) number *= scale;
        image.pixels[4] *= 1e-4f;
        write_image(folder.path("a.pfm"), image, {});
        const ScenePtr scene = scene_with(folder, "a.pfm", "emission_map t");
        EXPECT_TRUE(scene->warnings.empty()) << scene->warnings[0];
        const auto light = [&](size_t texel) {
            return bright_light(scene->textures[0], scene->texels[texel])[1] / double(scale);
        };
        EXPECT_NEAR(light(0), 4, 0.01) << scale;
        EXPECT_NEAR(light(3), 0.5, 0.001) << scale;
        EXPECT_NEAR(light(4), 1.25, 0.01) << "the smaller picture, " << scale;
    }
}

TEST(ImportPictures, OfFloatsSayWhatIsLost) {
    const Scratch folder;
    folder.write("a.hdr", kHdr);
    const auto warned = [&](const std::string& file, const std::string& material, const char* of) {
        const ScenePtr scene = scene_with(folder, file, material);
        ASSERT_EQ(scene->warnings.size(), 1u) << file << ", " << material;
        EXPECT_NE(scene->warnings[0].find(of), std::string::npos) << scene->warnings[0];
    };
    warned("a.hdr", "color_map t", "material 'm' has a picture of its colour with light above 1, which counts as 1");
    EXPECT_TRUE(scene_with(folder, "a.hdr", "model unlit color_map t")->warnings.empty());
    FloatImage image = bright_picture();
    image.pixels[0] = image.pixels[1] = image.pixels[2] = 0.5f;
    write_image(folder.path("dim.exr"), image, {});
    EXPECT_TRUE(scene_with(folder, "dim.exr", "color_map t")->warnings.empty());
    warned("dim.exr", "alpha blend color_map t", "material 'm' has no alpha of the picture of its colour");
    image.pixels[4] = -2, image.pixels[5] = HUGE_VALF, image.pixels[6] = 1e16f;
    write_image(folder.path("odd.pfm"), image, {});
    warned("odd.pfm", "emission_map t",
           "texture 'odd.pfm': 2 of its numbers are negative or not finite; they count as 0; 1 of its");
    std::string bytes;
    ASSERT_FALSE(try_read_file(folder.path("dim.exr"), 1 << 20, bytes));
    folder.write("cut.exr", bytes.substr(0, bytes.size() / 2));
    warned("cut.exr", "emission_map t", "texture 'cut.exr': the picture cannot be read: ");
    folder.write("cut.pfm", "PF\n70000 3\n-1\n");
    warned("cut.pfm", "emission_map t", "70000 x 3 pixels: at most 16384");
}

// Heights and opacities are numbers up to 1.
TEST(ImportPictures, OfFloatsAreHeightsToo) {
    const Scratch folder;
    folder.write("a.hdr", kHdr);
    const ScenePtr scene =
        load_scene(folder.write("a.scene", "texture t a.hdr space height\nmaterial m normal_map t\nsphere material m\n"));
    EXPECT_TRUE(scene->warnings.empty()) << scene->warnings[0];
    EXPECT_EQ(scene->textures[0].flags, RT_TEXTURE_LINEAR);
    EXPECT_EQ(scene->texels[0] >> 24, 255u);
}

}  // namespace
