// film_noise_test.cpp -- how large the error of a film is, and which of its pixels have samples enough.
#include "picture/film_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <set>

using namespace clarity;

namespace {

constexpr unsigned kSize = 24;

struct Pixel {
    double light, variance, samples;
};

FloatImage film_of(const std::function<Pixel(unsigned x, unsigned y)>& pixel) {
    FloatImage sums{kSize, 2 * kSize, 4, {}};
    sums.pixels.assign(kSize * kSize * 8, 0.0f);
    for (unsigned i = 0; i < kSize * kSize; ++i) {
        const Pixel p = pixel(i % kSize, i / kSize);
        for (unsigned c = 0; c < 3; ++c) sums.pixels[4 * i + c] = float(p.light * p.samples);
        sums.pixels[4 * i + 3] = float(p.samples);
        sums.pixels[4 * (kSize * kSize + i) + 3] = float(p.variance * (p.samples - 1));
    }
    return sums;
}

bool rests(const FloatImage& sums, unsigned x, unsigned y) {
    return std::signbit(sums.pixels[4 * (kSize * kSize + y * kSize + x) + 3]);
}
unsigned resting(const FloatImage& sums) {
    unsigned count = 0;
    for (unsigned i = 0; i < kSize * kSize; ++i) count += rests(sums, i % kSize, i / kSize);
    return count;
}

}  // namespace

TEST(FilmNoise, IsTheStandardErrorByTheLight) {
    const FilmNoise noise = film_noise(film_of([](unsigned x, unsigned) { return Pixel{2, x < kSize / 2 ? 4.0 : 0, 100}; }));
    EXPECT_NEAR(noise.error, std::sqrt(4.0 / 100 / 2) / 2, 1e-6);
    EXPECT_EQ(noise.mean_samples, 100);
    EXPECT_TRUE(std::isinf(film_noise(film_of([](unsigned x, unsigned) { return Pixel{1, 1, x ? 9.0 : 1}; })).error));
    EXPECT_EQ(film_noise(film_of([](unsigned, unsigned) { return Pixel{0, 0, 9}; })).error, 0);
}

TEST(FilmNoise, LeavesOutPixelsThatAreNoNumber) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    FloatImage sums = film_of([&](unsigned x, unsigned y) { return x + y == 0 ? Pixel{none, none, 64} : Pixel{1, 1, 64}; });
    EXPECT_NEAR(film_noise(sums).error, 1.0 / 8, 1e-6);
    EXPECT_EQ(mark_resting(sums, 0.2, 64), 0u) << "more samples would not mend it";
    EXPECT_TRUE(rests(sums, 2, 2));
    EXPECT_EQ(mark_resting(sums, 0.1, 64), uint64_t(kSize * kSize - 1));
}

TEST(FilmNoise, IsLookedAtNowAndThen) {
    std::vector<unsigned> looks;
    for (unsigned samples = 1; samples <= 512; ++samples)
        if (is_look(samples)) looks.push_back(samples);
    EXPECT_EQ(looks, (std::vector<unsigned>{32, 48, 64, 96, 128, 192, 256, 384, 512}));
    EXPECT_EQ(next_look(0), 32u);
    EXPECT_EQ(next_look(1u << 20), 3u << 19);
}

// By its light, or the picture's where it is darker; so that neither dark nor bright parts get all samples.
TEST(FilmNoise, PixelsRestWhenTheirErrorIsSmall) {
    const auto noisy = [](double light, double variance) {
        FloatImage sums =
            film_of([&](unsigned x, unsigned) { return x < 21 ? Pixel{1, 0.01, 100} : Pixel{light, variance, 100}; });
        return mark_resting(sums, 0.1, 96) / double(kSize * kSize);
    };
    EXPECT_EQ(noisy(1, 0.5), 0);
    EXPECT_GE(noisy(1, 2), 0.125) << "an error of 0.14";
    EXPECT_EQ(noisy(8, 8), 0) << "of its light";
    EXPECT_EQ(noisy(0.01, 0.1), 0) << "of the mean light";
    EXPECT_GE(noisy(0.01, 2), 0.125);
}

// What was black in some samples may be lit in the next one.
TEST(FilmNoise, BlackPixelsNeedSamplesToRest) {
    const auto film = [](double samples) {
        return film_of([=](unsigned x, unsigned y) { return x == 12 && y == 12 ? Pixel{5, 50, 1e4} : Pixel{0, 0, samples}; });
    };
    FloatImage few = film(64), many = film(4096);
    mark_resting(few, 0.2, 64);
    EXPECT_FALSE(rests(few, 1, 1));
    mark_resting(many, 0.2, 4096);
    EXPECT_TRUE(rests(many, 1, 1) && rests(many, 2, 1) && rests(many, 1, 2));
    FloatImage black = film_of([](unsigned, unsigned) { return Pixel{0, 0, 4096}; });
    mark_resting(black, 0.2, 4096);
    EXPECT_EQ(resting(black), 0u) << "nothing is known of a picture that is black";
}

// A pixel may have seen no noise by chance.
TEST(FilmNoise, NeighboursOfNoisyPixelsDoNotRest) {
    FloatImage sums = film_of([](unsigned x, unsigned) { return Pixel{1, x < 12 ? 20.0 : 0, 256}; });
    mark_resting(sums, 0.1, 256);
    EXPECT_FALSE(rests(sums, 13, 5));
    EXPECT_TRUE(rests(sums, 17, 5) && rests(sums, 18, 5));
}

TEST(FilmNoise, EachPixelHasItsTurn) {
    FloatImage sums = film_of([](unsigned, unsigned) { return Pixel{1, 0.01, 256}; });
    std::set<unsigned> had_it;
    unsigned look = 0;
    for (int i = 0; i < 16; ++i) {
        look = next_look(look);
        EXPECT_EQ(mark_resting(sums, 0.1, look), 0u);
        EXPECT_EQ(resting(sums), kSize * kSize * 15 / 16);
        for (unsigned p = 0; p < kSize * kSize; ++p)
            if (!rests(sums, p % kSize, p / kSize)) had_it.insert(p);
    }
    EXPECT_EQ(had_it.size(), size_t(kSize * kSize));
}
