// false_colors.hpp -- pictures of quantities that are no colours.
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "render/film/image_io.hpp"
#include "render/settings/false_color_scale.hpp"

namespace clarity {

// sRGB of the bar at a position, 0 = min to 1 = max.
std::array<uint8_t, 3> color_at(const FalseColorScale& scale, float position);

// The scale that false_colors() would choose. most: value at the upper end; 0: the largest of the picture.
FalseColorScale scale_of(const FloatImage& values, const std::string& aov, float most = 0);

// t: near is bright; prim, instance: a colour a number; normal: xyz to rgb; uv: to red and green; counts and shares: dark blue
// to yellow. What was not hit is black.
ByteImage false_colors(const FloatImage& values, const std::string& aov, const FalseColorScale& scale);

}  // namespace clarity
