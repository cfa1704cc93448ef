// math_test.cpp -- cl/sampling/math.h and warps.h against the library's functions in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "base/angle.hpp"
#include "render/tracers/path/lane_kernel.hpp"
#include "support/workbench.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

const std::vector<std::string> kHeaders = {"lanes/lanes.h", "lanes/vec.h", "sampling/math.h", "sampling/warps.h"};

// Rows of x, y -> sin x, cos x, sin and cos of 2 pi y, 2^x, e^x, atan2(y, x), acos(y), linear of y.
const char* const kBody =
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
    const std::vector<float> found = LaneKernel(kHeaders, 2, 9, kBody, 16).run(rows);
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
    const std::vector<float> rows = numbers(), one = LaneKernel(kHeaders, 2, 9, kBody, 1).run(rows);
    for (const int lanes : lane_counts()) {
        const std::vector<float> found = LaneKernel(kHeaders, 2, 9, kBody, unsigned(lanes)).run(rows);
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
