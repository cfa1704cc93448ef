// samplers_test.cpp -- the random numbers of paths (cl/sampling/dimensions.h): uniform, independent of each other where they
// should be, and spread evenly over a pixel's samples by Sobol's sequence.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "render/tracers/path/lane_kernel.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

struct Asked {
    unsigned pixel, sample, set, seed;
};

// Four numbers for each.
std::vector<float> numbers_of(bool sobol, const std::vector<Asked>& asked) {
    const std::vector<std::string> parts = {"lanes/lanes.h", "lanes/vec.h", "sampling/hash.h", "sampling/sobol.h",
                                            "sampling/dimensions.h"};
    const std::string body = std::string("rt_sampler s; s.sobol = ") + (sobol ? "1u" : "0u") +
                             "; s.end = 1u << 16; s.seed = (uint)given[3];"
                             "s.pixel = rt_to_int(in[0]); s.sample = rt_to_int(in[1]);"
                             "rt_numbers n = rt_draw_set(&s, rt_to_int(in[2]));"
                             "out[0] = n.a; out[1] = n.b; out[2] = n.c; out[3] = n.d;";
    static LaneKernel* kernels[2] = {};  // never destroyed: see LaneKernel::device()
    if (!kernels[sobol]) kernels[sobol] = new LaneKernel(parts, 4, 4, body, 8);
    std::vector<float> rows;
    for (const Asked& a : asked) rows.insert(rows.end(), {float(a.pixel), float(a.sample), float(a.set), float(a.seed)});
    return kernels[sobol]->run(std::move(rows));
}

constexpr unsigned kCount = 1u << 16;

std::vector<Asked> asked_of(const std::function<Asked(unsigned)>& of) {
    std::vector<Asked> asked(kCount);
    for (unsigned i = 0; i < kCount; ++i) asked[i] = of(i);
    return asked;
}

// Pearson's chi-square of pairs in 16 x 16 cells, as deviations of its own from its mean.
double misfit(const std::function<std::pair<float, float>(size_t)>& pair) {
    std::vector<double> cells(256);
    for (size_t i = 0; i < kCount; ++i) {
        const auto [x, y] = pair(i);
        if (!(x >= 0 && x < 1 && y >= 0 && y < 1)) return 1e9;
        ++cells[size_t(x * 16) * 16 + size_t(y * 16)];
    }
    double sum = 0;
    for (const double cell : cells) sum += (cell - kCount / 256.0) * (cell - kCount / 256.0) / (kCount / 256.0);
    return (sum - 255) / std::sqrt(510.0);
}

// Each number of a row is uniform, and independent of the others of its row and of those of the next row.
void expect_uniform(const std::vector<float>& numbers, const std::string& what) {
    for (size_t a = 0; a < 4; ++a) {
        for (size_t b = a + 1; b < 4; ++b)
            EXPECT_LT(std::fabs(misfit([&](size_t i) { return std::pair(numbers[4 * i + a], numbers[4 * i + b]); })), 5)
                << what << ", dimensions " << a << " and " << b;
        EXPECT_LT(
            std::fabs(misfit([&](size_t i) { return std::pair(numbers[4 * i + a], numbers[4 * ((i + 1) % kCount) + a]); })), 5)
            << what << ", dimension " << a << " of neighbours";
    }
}

}  // namespace

TEST(PathSamplers, NumbersAreUniformAndIndependent) {
    for (const bool sobol : {false, true}) {
        const std::string name = sobol ? "sobol" : "independent";
        expect_uniform(numbers_of(sobol, asked_of([](unsigned i) { return Asked{i, 5, 3, 1}; })), name + ", pixels");
        expect_uniform(numbers_of(sobol, asked_of([](unsigned i) { return Asked{i / 256, 7, i % 256, 1}; })), name + ", sets");
    }
    expect_uniform(numbers_of(false, asked_of([](unsigned i) { return Asked{9, i, 3, 1}; })), "samples");
}

TEST(PathSamplers, SeedsGiveOtherNumbers) {
    for (const bool sobol : {false, true}) {
        const auto of = [&](unsigned seed) {
            return numbers_of(sobol, asked_of([&](unsigned i) { return Asked{i / 16, i % 16, 2, seed}; }));
        };
        const std::vector<float> one = of(1), two = of(2);
        for (size_t a = 0; a < 4; ++a)
            EXPECT_LT(misfit([&](size_t i) { return std::pair(one[4 * i + a], two[4 * i + a]); }), 5) << sobol << " " << a;
    }
}

// Of every 64 samples of a pixel one is in each 64th of each dimension, and one in each box of that area of the first two: they
// are a net, and stay one whatever scrambles them.
TEST(PathSamplers, SobolIsEvenWithinAPixel) {
    const std::vector<float> numbers = numbers_of(true, asked_of([](unsigned i) {
                                                      return Asked{i / 1024, i % 256, i / 256 % 4, 1};
                                                  }));
    for (size_t first = 0; first < kCount; first += 64) {
        const auto expect_one_in_each = [&](const std::function<unsigned(const float*)>& cell, const std::string& what) {
            std::vector<int> count(64);
            for (size_t i = first; i < first + 64; ++i) ++count[cell(&numbers[4 * i])];
            for (const int c : count) ASSERT_EQ(c, 1) << what << ", samples from " << first;
        };
        for (size_t k = 0; k < 4; ++k)
            expect_one_in_each([&](const float* n) { return unsigned(n[k] * 64); }, "dimension " + std::to_string(k));
        for (unsigned wide = 2; wide < 64; wide *= 2)
            expect_one_in_each(
                [&](const float* n) { return unsigned(n[0] * wide) * (64 / wide) + unsigned(n[1] * (64 / wide)); },
                std::to_string(wide) + " columns");
    }
}
