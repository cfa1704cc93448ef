// numbers_test.cpp -- the random numbers of paths (cl/sampling/dimensions.h): uniform, independent of each other where they
// should be, and spread evenly over a pixel's samples by Sobol's sequence.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <random>

#include "base/angle.hpp"
#include "support/workbench.hpp"
#include "tracers/path/lane_kernel.hpp"

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
    const std::vector<float> numbers =
        numbers_of(true, asked_of([](unsigned i) { return Asked{i / 1024, i % 256, i / 256 % 4, 1}; }));
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

// A pixel's samples are added in their order, without drift (cl/tracers/path/sum.h).

namespace {

// The two planes of a film of one pixel after `count` samples, of the color `even` and of `odd` in turns.
std::vector<float> summed(const cl_float4& even, const cl_float4& odd, unsigned count) {
    Device& device = LaneKernel::device();
    const std::string text = "#define RT_LANES 1\n#define RT_CPU 1\n" + kernel_text("rt_shared.h") + "\n" +
                             kernel_text("rt_types.h") + "\n" + kernel_text("lanes/lanes.h") + "\n" +
                             kernel_text("tracers/path/sum.h") +
                             "\nkernel void add(global float4 *film, const float4 even, const float4 odd, const uint count)\n"
                             "{ for (uint i = 0; i < count; ++i) rt_add_sample(film, 1, 0, i % 2u ? odd : even, i == 0u); }\n";
    cl::Kernel kernel(build_program(device, text, "-cl-std=CL1.2", "a test's sums").program, "add");
    std::vector<float> film(8);
    const cl::Buffer buffer(device.context(), CL_MEM_READ_WRITE, 32);
    kernel.setArg(0, buffer);
    kernel.setArg(1, even);
    kernel.setArg(2, odd);
    kernel.setArg(3, cl_uint(count));
    device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1), cl::NDRange(1));
    device.queue().enqueueReadBuffer(buffer, CL_TRUE, 0, 32, film.data());
    return film;
}

}  // namespace

// 0.1 and 1/3 are no floats: a plain sum of a million of them is off by 0.010 and 0.003.
TEST(PathSums, OfAMillionSamplesAreExact) {
    const cl_float4 light = {{0.5f, 0.1f, 1.0f / 3, 0}};
    const std::vector<float> film = summed(light, light, 1u << 20);
    ASSERT_EQ(film[3], 1u << 20);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(film[size_t(k)] / film[3] / double(light.s[k]), 1, 1e-7) << k;
}

// Rounding must not make it negative: the standard error would be no number.
TEST(PathSums, OfEqualSamplesHaveNoVariance) {
    for (const float value : {1.0f, 0.7f, 0.1f, 1.3f, 17.3f, 1e-3f}) {
        const std::vector<float> film = summed({{value, value, value, 0}}, {{value, value, value, 0}}, 1000);
        EXPECT_GE(film[7], 0) << value;
        EXPECT_LE(film[7] / film[3], 1e-12 * value * value) << value;
    }
}

TEST(PathSums, KnowTheirVariance) {
    const cl_float4 dark = {{0, 0, 0, 0}}, bright = {{2, 2, 2, 0}};
    const std::vector<float> film = summed(dark, bright, 1u << 16);
    EXPECT_NEAR(film[0] / film[3], 1, 1e-7);
    EXPECT_NEAR(film[7] / film[3], 1, 1e-4);
}

// Cl/sampling/math.h and warps.h against the library's functions in double precision.

namespace {

const std::vector<std::string> kHeaders = {"lanes/lanes.h", "lanes/vec.h", "sampling/math.h", "sampling/warps.h"};

// Rows of x, y -> sin x, cos x, sin and cos of 2 pi y, 2^x, e^x, atan2(y, x), acos(y), linear of y.
const char* const kMathBody =
    "rt_sin_cos(in[0], out, out + 1); rt_sin_cos_turns(in[1], out + 2, out + 3); out[4] = rt_exp2(in[0]); out[5] = "
    "rt_exp(in[0]);"
    "out[6] = rt_atan2(in[1], in[0]); out[7] = rt_acos(in[1]); out[8] = rt_srgb_to_linear(in[1]);";

std::vector<float> numbers() {
    std::mt19937 random(3);
    std::vector<float> rows;
    const float ends[] = {0, 1e-30f, 1e-8f, 0.5f, 1, 10, 100, 126, 128, 1000, 9999, 0.04045f, 0.70710678f};
    for (const float x : ends)
        for (const float y : ends)
            for (const float sx : {1.0f, -1.0f})
                for (const float sy : {1.0f, -1.0f}) rows.insert(rows.end(), {sx * x, sy * y});
    for (const float range : {1.0f, 10.0f, 120.0f, 10000.0f})
        for (int i = 0; i < 30000; ++i) {
            std::uniform_real_distribution<float> x(-range, range), y(-1, 1);
            rows.insert(rows.end(), {x(random), y(random)});
        }
    for (int i = 0; i < 256; ++i) rows.insert(rows.end(), {float(i), float(i) / 255});
    return rows;
}

}  // namespace

TEST(PathMath, FunctionsAgreeWithTheLibrary) {
    const std::vector<float> rows = numbers();
    const std::vector<float> found = LaneKernel(kHeaders, 2, 9, kMathBody, 16).run(rows);
    double worst[9] = {};
    const auto note = [&](int k, double is, double should, double scale = 1) {
        worst[k] = std::max(worst[k], std::isfinite(is) ? std::abs(is - should) / scale : 1e30);
    };
    for (size_t i = 0; i < rows.size() / 2; ++i) {
        const double x = rows[2 * i], y = rows[2 * i + 1];
        const float* r = &found[9 * i];
        note(0, r[0], std::sin(x));
        note(1, r[1], std::cos(x));
        if (std::abs(y) <= 1000) {
            note(2, r[2], std::sin(2 * kPi * y));
            note(3, r[3], std::cos(2 * kPi * y));
        }
        if (x >= -126 && x <= 127.9) note(4, r[4], std::exp2(x), std::exp2(x));
        if (x < -126) note(4, r[4], 0, 1);
        if (x >= -87 && x <= 88) note(5, r[5], std::exp(x), std::exp(x) * std::max(1.0, (1 + std::abs(x)) / 2.5));
        if (x < -87.4) note(5, r[5], 0, 1);
        note(6, r[6], std::atan2(y == 0 ? 0.0 : y, x == 0 && y == 0 ? 1.0 : x));
        note(7, r[7], std::acos(std::fmax(-1, std::fmin(1, y))));
        if (y >= 0 && y <= 1) note(8, r[8], srgb_to_linear(y));
    }
    const double bounds[9] = {1.2e-7, 1.2e-7, 1.2e-7, 1.2e-7, 1.5e-7, 2.5e-7, 4e-7, 4e-7, 5e-7};
    const char* const names[9] = {"sin", "cos", "sin of turns", "cos of turns", "exp2", "exp", "atan2", "acos", "sRGB"};
    for (int k = 0; k < 9; ++k) {
        EXPECT_LE(worst[k], bounds[k]) << names[k];
        RecordProperty(names[k], std::to_string(worst[k]));
    }
}

TEST(PathMath, LanesAgree) {
    const std::vector<float> rows = numbers(), one = LaneKernel(kHeaders, 2, 9, kMathBody, 1).run(rows);
    for (const int lanes : lane_counts()) {
        const std::vector<float> found = LaneKernel(kHeaders, 2, 9, kMathBody, unsigned(lanes)).run(rows);
        EXPECT_EQ(std::memcmp(found.data(), one.data(), 4 * one.size()), 0) << lanes << " lanes";
    }
}

// Strata of the unit square have equal shares of what the density says, and moments are those of the domain.
TEST(PathMath, WarpsHaveTheirDensities) {
    const char* const body =
        "rt_vec w; rt_warp_disc(in[0], in[1], out, out + 1); w = rt_warp_cosine(in[0], in[1]); out[2] = w.x; out[3] = w.y; "
        "out[4] = w.z;"
        "rt_warp_triangle(in[0], in[1], out + 5, out + 6); w = rt_warp_cone(in[0], in[1], rt_vfloat(0.3f)); out[7] = w.x; "
        "out[8] = w.y;"
        "out[9] = w.z; w = rt_warp_cone(in[0], in[1], rt_vfloat(2.0f)); out[10] = w.x; out[11] = w.y; out[12] = w.z;"
        "rt_vec s, t; w = rt_warp_cone(in[0], in[1], rt_vfloat(2.0f)); rt_basis(w, &s, &t);"
        "out[13] = fabs(rt_dot(s, t)) + fabs(rt_dot(s, w)) + fabs(rt_dot(t, w)) + fabs(rt_dot(s, s) - 1.0f) + fabs(rt_dot(t, "
        "t) - 1.0f);"
        "out[14] = w.x * (s.y * t.z - s.z * t.y) + w.y * (s.z * t.x - s.x * t.z) + w.z * (s.x * t.y - s.y * t.x);";
    const int side = 512;
    std::vector<float> rows;
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) rows.insert(rows.end(), {(float(i) + 0.5f) / side, (float(j) + 0.5f) / side});
    const std::vector<float> found = LaneKernel(kHeaders, 2, 15, body, 8).run(rows);
    // Means of x, x^2, y^2, xy of the disc; of x^2, z, z^2 of the directions; of b, c, b^2, bc of the triangle.
    double sum[24] = {}, apart = 0, right_handed = 2;
    const size_t n = size_t(side) * side;
    for (size_t i = 0; i < n; ++i) {
        const float* r = &found[15 * i];
        const double terms[] = {double(r[0]),         double(r[0]) * r[0], double(r[1]) * r[1],   double(r[0]) * r[1],
                                double(r[2]) * r[2],  double(r[4]),        double(r[4]) * r[4],   double(r[5]),
                                double(r[6]),         double(r[5]) * r[5], double(r[5]) * r[6],   double(r[7]) * r[7],
                                double(r[9]),         double(r[9]) * r[9], double(r[10]) * r[10], double(r[12]),
                                double(r[12]) * r[12]};
        for (int k = 0; k < 17; ++k) sum[k] += terms[k] / double(n);
        EXPECT_NEAR(r[2] * r[2] + r[3] * r[3] + r[4] * r[4], 1, 1e-6);
        apart = std::max(apart, double(r[13]));
        right_handed = std::min(right_handed, double(r[14]));
    }
    const double cone = 1 - 0.15, cone2 = (1 - std::pow(0.7, 3)) / 3 / 0.3;
    const double expected[] = {0,    0.25,    0.25,    0,       0.25,     2.0 / 3,
                               0.5,  1.0 / 3, 1.0 / 3, 1.0 / 6, 1.0 / 12, (1 - cone2) / 2,
                               cone, cone2,   1.0 / 3, 0,       1.0 / 3};
    for (int k = 0; k < 17; ++k) EXPECT_NEAR(sum[k], expected[k], 1e-4) << "moment " << k;  // 4e-5 is the midpoint rule's
    EXPECT_LT(apart, 2e-6);
    EXPECT_GT(right_handed, 1 - 2e-6);
}
