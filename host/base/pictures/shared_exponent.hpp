// shared_exponent.hpp -- a colour of light in 32 bits: three numbers of 9 bits, and one exponent of 5 for all three. Format and
// rounding: Khronos' EXT_texture_shared_exponent (2004), as OpenGL's RGB9_E5 and Vulkan's E5B9G9R9 have it.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace clarity {

inline constexpr float kBrightestShared = 65408;           // 511/512 of 2^16
inline constexpr float kDarkestShared = 1.0f / (1 << 16);  // 2^-16: what is darker has less than 9 digits

// r in the lowest bits, the exponent in the highest. rgb: finite and not negative; what is beyond kBrightestShared becomes it.
inline uint32_t to_shared_exponent(const float* rgb) {
    const float most = std::min(std::max({rgb[0], rgb[1], rgb[2]}), kBrightestShared);
    if (!(most > 0)) return 0;
    constexpr int kBias = 15, kDigits = 9;
    int power = 0;
    std::frexp(most, &power);  // most < 2^power
    int exponent = std::max(power + kBias, 0);
    const auto digits = [&](float x) {
        return static_cast<uint32_t>(std::floor(std::ldexp(std::min(x, kBrightestShared), kBias + kDigits - exponent) + 0.5f));
    };
    if (digits(most) == 1u << kDigits) ++exponent;
    return digits(rgb[0]) | digits(rgb[1]) << kDigits | digits(rgb[2]) << (2 * kDigits) |
           static_cast<uint32_t>(exponent) << (3 * kDigits);
}

inline std::array<float, 3> from_shared_exponent(uint32_t texel) {
    const float step = std::ldexp(1.0f, static_cast<int>(texel >> 27) - 24);
    return {step * static_cast<float>(texel & 511u), step * static_cast<float>(texel >> 9 & 511u),
            step * static_cast<float>(texel >> 18 & 511u)};
}

}  // namespace clarity
