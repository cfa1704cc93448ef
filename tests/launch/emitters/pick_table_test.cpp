// pick_table_test.cpp -- the table of emitters deals out all numbers, exactly as it says.
#include "launch/emitters/sky_table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "scene/emissive.hpp"

using namespace clarity;

namespace {

// How many of all numbers pick each emitter, as kernels look them up.
std::vector<rt_u32> counted(const std::vector<rt_emitter>& table, unsigned bits, size_t count) {
    std::vector<rt_u32> picked(count, 0);
    const unsigned rest_bits = RT_PICK_BITS - bits;
    for (rt_u32 number = 0; number < RT_PICKS; ++number) {
        const rt_u32 cell = number >> rest_bits, rest = number & ((1u << rest_bits) - 1);
        const rt_u32 emitter = rest < table[cell].threshold ? cell : table[cell].alias;
        if (emitter >= count) {
            ADD_FAILURE() << "number " << number << " picks " << emitter;
            return picked;
        }
        ++picked[emitter];
    }
    return picked;
}

void expect_exact(const std::vector<double>& weights, double tolerance) {
    std::vector<rt_emitter> table(weights.size());
    const unsigned bits = fill_pick_table(weights, table);
    ASSERT_EQ(table.size(), size_t(1) << bits);
    const std::vector<rt_u32> picked = counted(table, bits, weights.size());
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (size_t i = 0; i < weights.size(); ++i) {
        ASSERT_EQ(double(picked[i]) / RT_PICKS, double(table[i].pick))
            << "emitter " << i << ": its probability is not what is drawn";
        ASSERT_EQ(picked[i] > 0, weights[i] > 0) << i;
        ASSERT_NEAR(double(picked[i]) / RT_PICKS, weights[i] / sum, tolerance * weights[i] / sum + 2.0 / RT_PICKS) << i;
    }
}

TEST(PickTable, OneEmitterTakesAll) {
    expect_exact({7}, 0);
}

TEST(PickTable, SomeWithoutWeightAreNeverPicked) {
    expect_exact({0, 3, 0, 1, 0}, 1e-6);
}

TEST(PickTable, AQuarterOfAMillionAlike) {
    expect_exact(std::vector<double>(1u << 18, 0.3), 0);
}

TEST(PickTable, AnyNumberOfAnyWeights) {
    std::mt19937 generator(1);
    std::uniform_real_distribution<double> exponent(-20, 20);
    for (const size_t count : {2, 3, 100, 1000, 70000}) {
        std::vector<double> weights(count);
        for (double& weight : weights) weight = std::exp(exponent(generator));
        expect_exact(weights, double(count) / RT_PICKS * 2);
    }
}

TEST(PickTable, WithoutWeightNothingIsPicked) {
    std::vector<rt_emitter> table(3);
    EXPECT_EQ(fill_pick_table({0, 0, 0}, table), 2u);
    for (const rt_emitter& emitter : table) EXPECT_EQ(emitter.pick, 0);
}

TEST(ConvexPolygon, KnowsDentsStarsAndBends) {
    EXPECT_TRUE(is_convex(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}.data(), 4));
    EXPECT_TRUE(is_convex(std::vector<float>{0, 0, 0, 0, 1, 0, 1, 1, 0, 1, 0, 0}.data(), 4)) << "the other way around";
    EXPECT_FALSE(is_convex(std::vector<float>{0, 0, 0, 1, 0, 0, 0.2f, 0.2f, 0, 0, 1, 0}.data(), 4)) << "a dent";
    EXPECT_FALSE(is_convex(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0.5f, 0, 1, 0}.data(), 4)) << "not in a plane";
    std::vector<float> star;
    for (int i = 0; i < 5; ++i)
        for (const double x : {std::cos(i * 4 * 3.14159265 / 5), std::sin(i * 4 * 3.14159265 / 5), 0.0})
            star.push_back(float(x));
    EXPECT_FALSE(is_convex(star.data(), 5)) << "goes around twice";
}

}  // namespace
