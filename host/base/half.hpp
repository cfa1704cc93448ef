// half.hpp -- numbers of 16 bits: IEEE 754 binary16, as vload_half() of OpenCL reads them.
#pragma once
#include <cmath>
#include <cstdint>
#include <cstring>

namespace clarity {

inline constexpr float kLargestHalf = 65504;
inline constexpr float kLeastNormalHalf = 1.0f / 16384;  // 2^-14; below it halves are multiples of 2^-24

// The nearest half, of two the even one. x: finite and not negative; what is beyond kLargestHalf becomes kLargestHalf.
inline uint16_t to_half(float x) {
    if (x >= kLargestHalf) return 0x7bff;
    constexpr float kSteps = 16777216;  // 2^24
    if (x < kLeastNormalHalf) return static_cast<uint16_t>(std::nearbyint(x * kSteps));
    uint32_t bits = 0;
    std::memcpy(&bits, &x, sizeof bits);
    // 13 digits less, and exponents that count from -15 in place of -127.
    return static_cast<uint16_t>(((bits + 0xfffu + (bits >> 13 & 1u)) >> 13) - (112u << 10));
}

}  // namespace clarity
