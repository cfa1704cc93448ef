// bright_texture.hpp -- textures of light, which may be above 1. Their texels have a shared exponent
// (base/pictures/shared_exponent.hpp), are linear for every use, and have no alpha. They hold light divided by a power of two
// that the texture's flags name (base/pictures/light_range.hpp).
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/pictures/shared_exponent.hpp"
#include "scene/scene.hpp"

namespace clarity {

// A flag of rt_texture, beside RT_TEXTURE_LINEAR; and the bits of its flags that hold the power, from -128 to 127.
// cl/shading/textures.h has the same numbers.
inline constexpr rt_u32 kBrightTexture = 4, kBrightPowerShift = 8, kBrightPower = 0xffu << kBrightPowerShift;

inline bool is_bright(const rt_texture& texture) {
    return (texture.flags & kBrightTexture) != 0;
}
inline rt_u32 bright_flags(int power) {
    return kBrightTexture | (static_cast<rt_u32>(power) << kBrightPowerShift & kBrightPower);
}
inline int bright_power(const rt_texture& texture) {
    return static_cast<int8_t>(texture.flags >> kBrightPowerShift);
}
// The light that a texel of a bright texture stands for.
inline std::array<float, 3> bright_light(const rt_texture& texture, uint32_t texel) {
    std::array<float, 3> light = from_shared_exponent(texel);
    for (float& channel : light) channel = std::ldexp(channel, bright_power(texture));
    return light;
}
inline bool has_bright_textures(const Scene& scene) {
    return std::any_of(scene.textures.begin(), scene.textures.end(), is_bright);
}

}  // namespace clarity
