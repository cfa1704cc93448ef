// texture.hpp -- decodes pictures into texels.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "rt_types.h"

namespace clarity::import {

inline constexpr rt_u32 kMaxTextureSide = 16384;
// Bytes of all decoded textures of one scene, with their smaller pictures: as many as rt_texture can number. Whether a device
// holds them is asked when the scene is sent there.
inline constexpr uint64_t kMaxTexelBytes = uint64_t(16) << 30;
inline constexpr uint64_t kMaxPictureFileBytes = 256u << 20;

// Decodes a picture (PNG, JPEG, BMP, TGA, PSD, GIF, HDR, PNM; `bytes` as in the file), appends it to `texels` as RGBA8 with the
// top row first, and describes it in `texture`. Returns nothing on success; otherwise the reason, and nothing is
// appended.
Problem decode_texture(const uint8_t* bytes, uint64_t byte_count, std::vector<uint32_t>& texels, rt_texture& texture);

// Whether the picture has light above 1, which decode_texture() cuts off: Radiance's HDR.
bool loses_light(const uint8_t* bytes, uint64_t byte_count);

// Bytes that decode_texture() takes for a picture, and what follows it with its smaller ones, while `texels` grows: those that
// are there are copied then. 0: it is no picture.
uint64_t memory_of_texture(const uint8_t* bytes, uint64_t byte_count);

// Same as decode_texture(), for a picture of width x height RGBA8 texels in memory.
Problem copy_texture(const uint8_t* bytes, uint64_t byte_count, rt_u32 width, rt_u32 height, std::vector<uint32_t>& texels,
                     rt_texture& texture);

}  // namespace clarity::import
