// texture.hpp -- encoded pictures into texels.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "rt_types.h"

namespace clarity::import {

inline constexpr rt_u32 kMaxTextureSide = 16384;
inline constexpr uint64_t kMaxTexelBytes = 256u << 20;  // of one scene, decoded

// Appends the picture (PNG, JPEG, BMP, TGA, PSD, GIF, HDR, PNM; `bytes` as in the file) to `texels`, RGBA8, top row first, and
// describes it in `texture`. Empty on success, else why not; nothing is appended then.
std::string decode_texture(const uint8_t* bytes, uint64_t byte_count, std::vector<uint32_t>& texels, rt_texture& texture);

// As decode_texture, for width x height RGBA8 in memory.
std::string copy_texture(const uint8_t* bytes, uint64_t byte_count, rt_u32 width, rt_u32 height, std::vector<uint32_t>& texels,
                         rt_texture& texture);

}  // namespace clarity::import
