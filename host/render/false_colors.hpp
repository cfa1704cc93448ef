// false_colors.hpp -- pictures of quantities that are no colours.
#pragma once
#include <string>

#include "render/image_io.hpp"

namespace clarity {

// t: near is bright; prim, instance: a colour a number; normal: xyz to rgb; uv: to red and green; steps: dark blue to yellow,
// by the largest value. What was not hit is black.
ByteImage false_colors(const FloatImage& values, const std::string& aov);

}  // namespace clarity
