// import_pictures_test.cpp -- pictures of surfaces: large ones in small files, through the import worker, and those that lose
// light.
#include <gtest/gtest.h>

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

// An HDR picture with a texel of 4 and three of 0.5.
TEST(ImportPictures, AnHdrPictureOfASurfaceIsCutOffWithAWord) {
    const Scratch folder;
    const std::string half("\x80\x80\x80\x80", 4), bright("\x80\x80\x80\x83", 4);
    folder.write("a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n" + bright + half + half + half);
    const ScenePtr scene = load_scene(folder.write("a.scene", "texture t a.hdr\nmaterial m color_map t\nsphere material m\n"));
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_NE(scene->warnings[0].find("texture 'a.hdr': light above 1 is cut off"), std::string::npos) << scene->warnings[0];
    ASSERT_EQ(scene->textures.size(), 1u);
    EXPECT_EQ(scene->texels[scene->textures[0].first] & 0xffu, 255u);
    const ScenePtr sky = load_scene(folder.write("b.scene", "sky a.hdr\nsphere\n"));
    EXPECT_TRUE(sky->warnings.empty());
}

}  // namespace
