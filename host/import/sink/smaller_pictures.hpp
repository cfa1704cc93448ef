// smaller_pictures.hpp -- the smaller pictures of a texture (Williams 1983, "Pyramidal Parametrics").
#pragma once
#include <cstdint>
#include <vector>

#include "rt_types.h"

namespace clarity::import {

// Appends the smaller pictures of a texture, down to a single texel, whose own picture is the last one in `texels`. Each texel
// is the mean of what it covers of the picture before: of linear light where the texture is sRGB, of plain numbers else, as is
// alpha.
void add_smaller_pictures(std::vector<uint32_t>& texels, rt_texture& texture);

}  // namespace clarity::import
