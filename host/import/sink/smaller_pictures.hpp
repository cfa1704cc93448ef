// smaller_pictures.hpp -- the smaller pictures of a texture (Williams 1983, "Pyramidal Parametrics").
#pragma once
#include <cstdint>
#include <vector>

#include "rt_types.h"

namespace clarity::import {

// Appends the smaller pictures of a texture, down to one of a single texel. The texture's own picture is the last one in
// `texels`. Each texel is the mean of the part of the picture before that it covers. Colours of sRGB textures are averaged in
// linear light; alpha, and all of other textures, as plain numbers. Those of bright textures are light already.
void add_smaller_pictures(std::vector<uint32_t>& texels, rt_texture& texture);

}  // namespace clarity::import
