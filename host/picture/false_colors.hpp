// false_colors.hpp -- paints AOVs that are not colours.
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "base/pictures/image_io.hpp"
#include "view/settings/false_color_scale.hpp"

namespace clarity {

// Returns the sRGB colour of the scale at `position`, 0 = min to 1 = max.
std::array<uint8_t, 3> color_at(const FalseColorScale& scale, float position);

// Returns the scale that suits these values. most: value at the upper end; 0: the picture's largest.
FalseColorScale scale_of(const FloatImage& values, const std::string& aov, float most = 0);

// Paints the values. t: near is bright. prim, instance: one colour for each number. normal: xyz to rgb. uv: to red and green.
// Counts and shares: dark blue to yellow. Pixels without a hit are black.
ByteImage false_colors(const FloatImage& values, const std::string& aov, const FalseColorScale& scale);

}  // namespace clarity
