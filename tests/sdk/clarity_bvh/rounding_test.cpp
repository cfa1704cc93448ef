// rounding_test.cpp -- rounded_down() and rounded_up() against the definition, by std::nextafter().
#include "clarity_bvh/base/rounding.hpp"

#include <gtest/gtest.h>

#include <cfloat>
#include <random>
#include <vector>

namespace clarity::bvh {
namespace {

TEST(Rounding, IsToTheNextFloatOnEitherSide) {
    std::vector<double> numbers = {0,         5e-324,    1e-46,    1e-45,   1.1e-45,        FLT_MIN, 1,
                                   1 + 1e-12, 1 - 1e-12, 16777217, FLT_MAX, 3.402823567e38, 1e300,   HUGE_VAL};
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> mantissa(1, 2);
    std::uniform_int_distribution<int> exponent(-152, 130);
    for (int i = 0; i < 100000; ++i) numbers.push_back(std::ldexp(mantissa(random), exponent(random)));
    for (int i = 0; i < 1000; ++i) numbers.push_back(double(float(mantissa(random))));  // floats stay as they are
    size_t between = 0;
    for (const double positive : numbers)
        for (const double x : {positive, -positive}) {
            const float down = rounded_down(x), up = rounded_up(x);
            ASSERT_LE(down, x);
            ASSERT_GE(up, x);
            if (double(float(x)) == x) {
                ASSERT_EQ(down, x);
                ASSERT_EQ(up, x);
            } else {
                ASSERT_EQ(std::nextafter(down, INFINITY), up) << x;
                ++between;
            }
        }
    EXPECT_GT(between, 100000u);
}

}  // namespace
}  // namespace clarity::bvh
