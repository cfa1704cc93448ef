// Pictures are read back exactly, by readers that are not the program's. A write that fails leaves nothing behind.
#include "base/pictures/image_io.hpp"
#include "base/files/frame_path.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>

#include "base/error.hpp"
#include "support/scratch.hpp"

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#pragma GCC diagnostic pop
#ifdef CLARITY_HAVE_OPENEXR
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfStringAttribute.h>

#include "support/read_exr.hpp"
#endif

namespace fs = std::filesystem;
using namespace clarity;

namespace {

class ImageIo : public ::testing::Test {
 protected:
    std::string path(const std::string& name) const { return scratch_.path(name); }
    size_t file_count() const { return static_cast<size_t>(std::distance(fs::directory_iterator(path("")), {})); }

    Scratch scratch_;
};

// Values of every magnitude, including those that AOVs use for "no hit".
FloatImage sample_values(unsigned width, unsigned height, unsigned channels) {
    FloatImage image{width, height, channels, {}};
    for (size_t i = 0; i < size_t(width) * height * channels; ++i)
        image.pixels.push_back(i % 7 == 0   ? std::numeric_limits<float>::infinity()
                               : i % 5 == 0 ? -1.0f
                                            : std::ldexp(1.0f + float(i) * 0.013f, int(i % 41) - 20));
    return image;
}

ByteImage sample_bytes(unsigned width, unsigned height, bool opaque) {
    std::vector<uint8_t> pixels(size_t(width) * height * 4);
    for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = i % 4 == 3 && opaque ? 255 : static_cast<uint8_t>(i * 37 + i / 256);
    return {width, height, std::move(pixels)};
}

bool same_bits(const FloatPixels& a, const FloatPixels& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

// Returns the exit code and message of the Error that `body` throws.
std::pair<Exit, std::string> failure_of(const std::function<void()>& body) {
    try {
        body();
    } catch (const Error& e) {
        return {e.code(), e.what()};
    }
    return {Exit::done, "nothing was thrown"};
}

// Reads PFM as its description says: rows bottom-up, a negative scale for little endian.
FloatImage read_pfm(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    std::string magic;
    FloatImage image;
    double scale = 0;
    in >> magic >> image.width >> image.height >> scale;
    EXPECT_EQ(in.get(), '\n');
    EXPECT_TRUE(magic == "PF" || magic == "Pf") << magic;
    EXPECT_EQ(scale, -1.0);
    image.channels = magic == "PF" ? 3 : 1;
    const size_t row = size_t(image.width) * image.channels;
    image.pixels.resize(row * image.height);
    for (unsigned y = image.height; y-- > 0;)
        in.read(reinterpret_cast<char*>(&image.pixels[y * row]), static_cast<std::streamsize>(row * sizeof(float)));
    EXPECT_TRUE(in.good());
    EXPECT_EQ(in.get(), EOF);
    return image;
}

}  // namespace

TEST_F(ImageIo, PngOfOpaquePixelsComesBack) {
    const ByteImage image = sample_bytes(37, 11, true);
    write_image(path("a.png"), {}, image);
    int width = 0, height = 0, channels = 0;
    stbi_uc* pixels = stbi_load(path("a.png").c_str(), &width, &height, &channels, 4);
    ASSERT_NE(pixels, nullptr) << stbi_failure_reason();
    EXPECT_EQ(width, 37);
    EXPECT_EQ(height, 11);
    EXPECT_EQ(channels, 3) << "an opaque alpha channel is omitted";
    EXPECT_EQ(std::memcmp(pixels, image.pixels.data(), image.pixels.size()), 0);
    stbi_image_free(pixels);
}

TEST_F(ImageIo, PngKeepsAlpha) {
    const ByteImage image = sample_bytes(5, 3, false);
    write_image(path("a.PNG"), {}, image);
    int width = 0, height = 0, channels = 0;
    stbi_uc* pixels = stbi_load(path("a.PNG").c_str(), &width, &height, &channels, 0);
    ASSERT_NE(pixels, nullptr) << stbi_failure_reason();
    EXPECT_EQ(channels, 4);
    EXPECT_EQ(std::memcmp(pixels, image.pixels.data(), image.pixels.size()), 0);
    stbi_image_free(pixels);
}

TEST_F(ImageIo, PfmIsExact) {
    for (const unsigned channels : {1u, 3u}) {
        const FloatImage image = sample_values(19, 7, channels);
        write_image(path("a.pfm"), image, {});
        const FloatImage back = read_pfm(path("a.pfm"));
        EXPECT_EQ(back.width, 19u);
        EXPECT_EQ(back.height, 7u);
        EXPECT_EQ(back.channels, channels);
        EXPECT_TRUE(same_bits(back.pixels, image.pixels));
    }
}

TEST_F(ImageIo, ExrIsExact) {
#ifdef CLARITY_HAVE_OPENEXR
    FloatImage image = sample_values(33, 40, 3);
    write_image(path("a.exr"), image, {});
    EXPECT_TRUE(same_bits(read_exr(path("a.exr"), {"R", "G", "B"}).pixels, image.pixels));
    image = sample_values(8, 5, 1);
    write_image(path("b.exr"), image, {});
    EXPECT_TRUE(same_bits(read_exr(path("b.exr"), {"Y"}).pixels, image.pixels));
#else
    EXPECT_NE(failure_of([&] { check_output_path(path("a.exr")); }).second.find("libopenexr-dev"), std::string::npos);
#endif
}

// Notes stand before the pixels, so that a reader finds them at the beginning of the file, and change no pixel.
TEST_F(ImageIo, NotesAreKept) {
    const ByteImage image = sample_bytes(37, 11, true);
    PictureNotes notes;
    notes.texts = {{"Command", "clarity render a.scene"}, {"Digest", "00ff"}, {"Place", "M\xc3\xbcnchen"}};
    notes.sync = true;
    write_image(path("a.png"), {}, image, notes);
    const std::string png = scratch_.read("a.png");
    const auto chunk = [&](const std::string& name, const std::string& data) {
        const std::string bytes{0, 0, char(data.size() >> 8), char(data.size())};
        const size_t at = png.find(bytes + name + data);
        return at != std::string::npos && at < png.find("IDAT");
    };
    EXPECT_TRUE(chunk("tEXt", std::string("Command\0clarity render a.scene", 30)));
    EXPECT_TRUE(chunk("tEXt", std::string("Digest\0", 7) + "00ff"));
    EXPECT_TRUE(chunk("iTXt", "Place" + std::string(5, '\0') + "M\xc3\xbcnchen")) << "tEXt is Latin-1";
    int width = 0, height = 0, channels = 0;
    stbi_uc* pixels = stbi_load(path("a.png").c_str(), &width, &height, &channels, 4);
    ASSERT_NE(pixels, nullptr) << stbi_failure_reason();
    EXPECT_EQ(std::memcmp(pixels, image.pixels.data(), image.pixels.size()), 0);
    stbi_image_free(pixels);
#ifdef CLARITY_HAVE_OPENEXR
    const FloatImage values = sample_values(33, 40, 3);
    write_image(path("a.exr"), values, {}, notes);
    EXPECT_TRUE(same_bits(read_exr(path("a.exr"), {"R", "G", "B"}).pixels, values.pixels));
    const Imf::InputFile file(path("a.exr").c_str());
    for (const auto& [key, value] : notes.texts) {
        const auto* text = file.header().findTypedAttribute<Imf::StringAttribute>(key);
        ASSERT_NE(text, nullptr) << key;
        EXPECT_EQ(text->value(), value);
    }
#endif
}

TEST_F(ImageIo, LayersAreExact) {
#ifdef CLARITY_HAVE_OPENEXR
    const FloatImage colors = sample_values(33, 40, 3), t = sample_values(33, 40, 1);
    FloatImage normal = colors;
    std::reverse(normal.pixels.begin(), normal.pixels.end());
    write_layers(path("a.exr"), {{"", colors}, {"normal", normal}, {"t", t}});
    EXPECT_TRUE(same_bits(read_exr(path("a.exr"), {"R", "G", "B"}).pixels, colors.pixels));
    EXPECT_TRUE(same_bits(read_exr(path("a.exr"), {"normal.X", "normal.Y", "normal.Z"}).pixels, normal.pixels));
    EXPECT_TRUE(same_bits(read_exr(path("a.exr"), {"t.Y"}).pixels, t.pixels));
    const auto refused = failure_of([&] { write_layers(path("b.exr"), {{"", colors}, {"t", sample_values(33, 39, 1)}}); });
    EXPECT_EQ(refused.first, Exit::failed) << "layers of other sizes";
    EXPECT_EQ(file_count(), 1u);
#endif
}

TEST_F(ImageIo, APictureWithoutAllItsPixelsIsNotWritten) {
    FloatImage values = sample_values(4, 4, 3);
    values.pixels.pop_back();
    const ByteImage bytes{4, 4, std::vector<uint8_t>(63)};
    for (const char* name : {"a.pfm", "a.exr", "a.png"})
        EXPECT_EQ(failure_of([&] { write_image(path(name), values, bytes); }).first, Exit::failed) << name;
    EXPECT_EQ(failure_of([&] { write_image(path("a.pfm"), sample_values(4, 4, 2), {}); }).first, Exit::failed);
    EXPECT_EQ(file_count(), 0u);
}

TEST_F(ImageIo, AFailingWriteLeavesTheOldFileAndNothingElse) {
    // A limit on file sizes is the simplest way to let a write fail half-way, even for root.
    const FloatImage image = sample_values(128, 128, 3);
    const ByteImage bytes = sample_bytes(128, 128, true);
    for (const char* name : {"a.pfm", "a.png", "a.exr"}) {
        std::ofstream(path(name)) << "old";
        const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
        rlimit old_limit{};
        getrlimit(RLIMIT_FSIZE, &old_limit);
        const rlimit small{256, old_limit.rlim_max};
        setrlimit(RLIMIT_FSIZE, &small);
        const auto [code, message] = failure_of([&] { write_image(path(name), image, bytes); });
        setrlimit(RLIMIT_FSIZE, &old_limit);
        std::signal(SIGXFSZ, old_handler);
#ifdef CLARITY_HAVE_OPENEXR
        EXPECT_EQ(code, Exit::failed) << name << ": " << message;
#endif
        EXPECT_NE(message.find(name), std::string::npos) << message;
        EXPECT_EQ(scratch_.read(name), "old") << name;
    }
    EXPECT_EQ(file_count(), 3u);
}

TEST_F(ImageIo, AnOldFileIsReplacedAndKeepsItsRights) {
    std::ofstream(path("a.pfm")) << "old";
    chmod(path("a.pfm").c_str(), 0640);
    write_image(path("a.pfm"), sample_values(2, 2, 1), {});
    struct stat status{};
    ASSERT_EQ(stat(path("a.pfm").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777, 0640u);
    EXPECT_EQ(read_pfm(path("a.pfm")).width, 2u);
    // Through a link: the link stays, its target is replaced.
    fs::create_symlink("a.pfm", path("link.pfm"));
    write_image(path("link.pfm"), sample_values(3, 2, 1), {});
    EXPECT_TRUE(fs::is_symlink(path("link.pfm")));
    EXPECT_EQ(read_pfm(path("a.pfm")).width, 3u);
    EXPECT_EQ(file_count(), 2u);
}

TEST_F(ImageIo, UnusablePathsAreFoundBeforeWork) {
    fs::create_directory(path("folder.png"));
    std::ofstream(path("file")) << "x";
    const std::string cases[] = {path("a.jpg"),      path("noending"),          path("missing/a.png"),
                                 path("folder.png"), path("file/a.png"),        "",
                                 path("a.png/"),     path("folder.png/.png/x"), path(std::string(300, 'x') + ".png")};
    for (const std::string& name : cases) {
        const auto [code, message] = failure_of([&] { check_output_path(name); });
        EXPECT_EQ(code, Exit::usage) << name << ": " << message;
        EXPECT_NE(message.find(name), std::string::npos) << message;
    }
    EXPECT_EQ(file_count(), 2u);
    check_output_path(path("new.png"));
    check_output_path(path("new.pfm"));
    EXPECT_EQ(file_count(), 2u) << "a check leaves no file behind";
}

TEST(FramePath, ReplacesTheLastRunOfHashes) {
    EXPECT_EQ(frame_path("out_####.png", 12), "out_0012.png");
    EXPECT_EQ(frame_path("out_#.png", 123), "out_123.png");
    EXPECT_EQ(frame_path("out.png", 12), "out.png");
    EXPECT_EQ(frame_path("a##/b###.exr", 7), "a##/b007.exr");
    EXPECT_EQ(frame_path("a##/b.exr", 7), "a##/b.exr");
    EXPECT_EQ(frame_path("####", 3), "0003");
    EXPECT_EQ(frame_path("x##y###.pfm", 3), "x##y003.pfm");
    EXPECT_EQ(frame_path("x###.pfm", -3), "x-03.pfm");
}
