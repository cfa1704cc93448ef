// half_test.cpp -- numbers of 16 bits.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/half.hpp"

namespace clarity::test {
namespace {

double value_of(unsigned bits) {
    const int exponent = static_cast<int>(bits >> 10), digits = static_cast<int>(bits & 1023);
    return exponent == 0 ? std::ldexp(digits, -24) : std::ldexp(digits + 1024, exponent - 25);
}

// Each half is its own; what lies between two becomes the nearer one, and the middle the even one.
TEST(Half, IsTheNearest) {
    for (unsigned bits = 0; bits < 0x7bff; ++bits) {
        const double here = value_of(bits), next = value_of(bits + 1), middle = (here + next) / 2;
        ASSERT_EQ(to_half(static_cast<float>(here)), bits);
        ASSERT_EQ(to_half(static_cast<float>(middle)), bits + (bits & 1)) << bits;
        ASSERT_EQ(to_half(std::nextafter(static_cast<float>(middle), 0.0f)), bits) << bits;
        ASSERT_EQ(to_half(std::nextafter(static_cast<float>(middle), 1e9f)), bits + 1) << bits;
    }
    EXPECT_EQ(value_of(0x7bff), kLargestHalf);
    EXPECT_EQ(to_half(kLargestHalf), 0x7bff);
    EXPECT_EQ(to_half(1e30f), 0x7bff);
}

}  // namespace
}  // namespace clarity::test
