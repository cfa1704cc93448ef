// errors_test.cpp -- figures of differing pictures: by hand, by closed forms, and FLIP by the program of its authors.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "base/error.hpp"
#include "base/pictures/picture_read.hpp"
#include "support/errors.hpp"
#include "support/scratch.hpp"
#include "tools/compare/flip.hpp"
#include "tools/compare/picture_errors.hpp"

using namespace clarity;

namespace {

FloatImage filled(unsigned width, unsigned height, float r, float g, float b) {
    FloatImage image{width, height, 3, {}};
    for (unsigned i = 0; i < width * height; ++i)
        for (const float v : {r, g, b}) image.pixels.push_back(v);
    return image;
}

double mean(const std::vector<float>& values) {
    double sum = 0;
    for (const float v : values) sum += v;
    return sum / static_cast<double>(values.size());
}

TEST(PictureErrors, AreWhatOneComputesByHand) {
    FloatImage reference = filled(100, 20, .5f, .5f, .5f), test = reference;
    test.pixels[3 * 205 + 1] += .3f;  // pixel 5,2
    const PictureErrors e = picture_errors(test, reference);
    EXPECT_EQ(e.pixels, 2000u);
    EXPECT_NEAR(e.rmse, std::sqrt(.09 / 6000), 1e-7);
    EXPECT_NEAR(e.relmse, .03 / (.25 + .01) / 2000, 1e-9);
    EXPECT_NEAR(e.mean_ratio, 1 + .3 / 3000, 1e-7);
    EXPECT_EQ(e.trimmed_rmse, 0) << "one pixel of 2000 is among the worst 0.1 %";
    EXPECT_NEAR(e.largest, .3, 1e-6);
    EXPECT_EQ(e.largest_x, 5u);
    EXPECT_EQ(e.largest_y, 2u);
    // The luminance of the reference weighs the error: in a green picture more than in a blue one.
    const auto relmse_of = [&](float r, float g, float b) {
        FloatImage to = filled(4, 4, r, g, b), from = filled(4, 4, r + .1f, g, b);
        return picture_errors(from, to).relmse;
    };
    EXPECT_NEAR(relmse_of(0, 1, 0), .01 / 3 / (.7152 * .7152 + .01), 1e-6);
    EXPECT_NEAR(relmse_of(0, 0, 1), .01 / 3 / (.0722 * .0722 + .01), 1e-6);
}

TEST(PictureErrors, LeaveOutWhatIsNotFinite) {
    FloatImage reference = filled(8, 8, .5f, .5f, .5f), test = reference;
    test.pixels[0] = NAN;
    reference.pixels[3 * 9] = INFINITY;
    const PictureErrors e = picture_errors(test, reference);
    EXPECT_EQ(e.not_finite, 2u);
    EXPECT_EQ(e.pixels, 62u);
    EXPECT_EQ(e.rmse, 0);
    EXPECT_EQ(e.mean_ratio, 1);
    EXPECT_TRUE(std::isnan(picture_errors(test, filled(8, 8, 0, 0, 0)).mean_ratio));
}

TEST(PictureErrors, OtherSizesAreRefused) {
    expect_error([&] { picture_errors(filled(8, 4, 0, 0, 0), filled(4, 8, 0, 0, 0)); }, {"8x4 and 4x8"});
}

TEST(SignedErrors, AreRedWhereBrighterAndBlueWhereDarker) {
    FloatImage reference = filled(3, 1, .5f, .5f, .5f), test = reference;
    for (int c = 0; c < 3; ++c) test.pixels[c] = .7f, test.pixels[3 + c] = .3f;
    double full = 0;
    const ByteImage picture = signed_error_picture(test, reference, full);
    EXPECT_NEAR(full, .2, 1e-6);
    EXPECT_TRUE((picture.pixels == std::vector<uint8_t>{255, 0, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255}));
}

// The pictures are equal, as different as two colours of a screen can be, or made by formula. Their values are those of
// FLIP.h 1.5 (github.com/NVlabs/flip), compiled and run on the same pictures.
TEST(Flip, IsThatOfItsAuthors) {
    const FloatImage green = filled(40, 40, 0, 1, 0), blue = filled(40, 40, 0, 0, 1);
    EXPECT_EQ(mean(flip(green, green)), 0);
    EXPECT_NEAR(mean(flip(blue, green)), 1, 1e-6);
    const auto made = [](bool other) {
        FloatImage image{96, 64, 3, {}};
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 96; ++x)
                for (int c = 0; c < 3; ++c) {
                    double v = .35 + .3 * std::sin(.11 * x * (c + 1) + .07 * y + (other ? .15 * c : 0));
                    if (((x + (other ? 1 : 0)) / 9 + y / 7) % 2) v += .25;
                    if (other && (x * 7 + y * 13) % 41 == 0) v += .4;
                    image.pixels.push_back(static_cast<float>(std::min(1.0, std::max(0.0, v))));
                }
        return image;
    };
    const std::vector<float> values = flip(made(true), made(false));
    EXPECT_NEAR(mean(values), .2538216, 2e-5);
    EXPECT_NEAR(values[0], .485319, 2e-4);
    EXPECT_NEAR(values[30 * 96 + 50], .221549, 2e-4);
    EXPECT_NEAR(values[63 * 96 + 95], .288274, 2e-4);
}

// What is written is read again: exactly, or within the 8 bits of a PNG.
TEST(ReadPicture, ReadsWhatIsWritten) {
    const Scratch scratch;
    FloatImage image{5, 3, 3, {}};
    for (int i = 0; i < 45; ++i) image.pixels.push_back(static_cast<float>(i) / 44);
    image.pixels[7] = 123.25f;
    std::vector<std::string> names = {"a.pfm"};
#ifdef CLARITY_HAVE_OPENEXR
    names.push_back("a.exr");
#endif
    for (const std::string& name : names) {
        write_image(scratch.path(name), image, {});
        const FloatImage read = read_picture(scratch.path(name));
        ASSERT_EQ(read.width, 5u);
        ASSERT_EQ(read.height, 3u);
        EXPECT_TRUE(std::equal(image.pixels.begin(), image.pixels.end(), read.pixels.begin(), read.pixels.end())) << name;
    }
    write_image(scratch.path("a.png"), {}, {2, 1, std::vector<uint8_t>{255, 0, 128, 255, 10, 20, 30, 128}});
    const FloatImage png = read_picture(scratch.path("a.png"));
    // By the exact curve: 128 / 255 is 0.215861 linear, 10 / 255 is on its straight part.
    const float expected[] = {1, 0, .2158605f, 10 / 255.f / 12.92f, .0069954f, .0129830f};
    ASSERT_EQ(png.pixels.size(), 6u);
    for (size_t i = 0; i < 6; ++i) EXPECT_NEAR(png.pixels[i], expected[i], 1e-6);
    // One channel, big endian, as other programs write it.
    std::ofstream(scratch.path("b.pfm"), std::ios::binary) << "Pf\n1 2\n1.0\n" << std::string("\x3f\x80\0\0\x40\0\0\0", 8);
    EXPECT_TRUE((read_picture(scratch.path("b.pfm")).pixels == FloatPixels{2, 2, 2, 1, 1, 1}));
}

TEST(ReadPicture, SaysWhatIsWrong) {
    const Scratch scratch;
    const auto said = [&](const std::string& bytes) {
        std::ofstream(scratch.path("x"), std::ios::binary) << bytes;
        try {
            read_picture(scratch.path("x"));
        } catch (const Error& e) {
            EXPECT_EQ(std::string(e.what()).find(scratch.path("x")), 0u);
            return std::string(e.what());
        }
        return std::string("nothing");
    };
    const auto says = [&](const std::string& bytes, const char* words) {
        const std::string text = said(bytes);
        EXPECT_NE(text.find(words), std::string::npos) << text;
    };
    says("", "none of PNG, EXR, HDR and PFM");
    says("GIF89a", "none of PNG, EXR, HDR and PFM");
    says("PF\n4 4\n-1.0\nshort", "cut off");
    says("PF\n4\n", "head");
    says("PF\n-4 4\n-1.0\n", "size");
    says("PF\n999999999 999999999\n-1.0\n", "size");
    says("\x89PNG\r\n\x1a\nbroken", "no PNG that can be read");
    says("\x76\x2f\x31\x01 broken", "cannot be read");
}

}  // namespace
