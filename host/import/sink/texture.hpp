// texture.hpp -- decodes pictures into texels, and makes of them what materials use: smaller pictures, normals of heights,
// opacity.
#pragma once
#include <cstddef>
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

// Decodes a picture (PNG, JPEG, BMP, TGA, PSD, GIF, PNM; `bytes` as in the file), appends it to `texels` as RGBA8 with the top
// row first, and describes it in `texture`. Pictures of floats (HDR, EXR, PFM) become bright textures, which keep light above 1
// (scene/bright_texture.hpp). Returns nothing on success; otherwise the reason, and nothing is appended. lost: what of the
// light is lost, for a warning; empty: nothing.
Problem decode_texture(const uint8_t* bytes, uint64_t byte_count, std::vector<uint32_t>& texels, rt_texture& texture,
                       std::string& lost);

// Makes numbers of a picture light: what is negative or not finite becomes 0, what is above 1e15 becomes that
// (scene/usable.hpp). Returns what was changed, for a warning; empty: nothing.
std::string make_sound_light(float* numbers, size_t count);

// Makes RGBA8 of a bright texture: numbers of 0..1 in linear steps. The texture's picture is the last one in `texels`.
void make_bytes(std::vector<uint32_t>& texels, rt_texture& texture);

// Bytes that decode_texture() takes for a picture, and what follows it with its smaller ones, while `texels` grows: those that
// are there are copied then. 0: it is no picture.
uint64_t memory_of_texture(const uint8_t* bytes, uint64_t byte_count);

// Same as decode_texture(), for a picture of width x height RGBA8 texels in memory.
Problem copy_texture(const uint8_t* bytes, uint64_t byte_count, rt_u32 width, rt_u32 height, std::vector<uint32_t>& texels,
                     rt_texture& texture);

// Pictures of heights (bump maps) as maps of normals.

// Turns a grey picture of heights, of width x height texels, into a map of normals: see RT_SPACE_HEIGHT. A picture of other
// colours is one already, and stays as it is.
void make_normals(uint32_t* texels, const rt_texture& picture);

// Pictures of an opacity that is not their red channel.

// Puts the opacity into all channels of the texels of a picture. space: RT_SPACE_ALPHA or RT_SPACE_CLEARNESS, as rt_plugin.h
// says.
void make_opacities(uint32_t* texels, const rt_texture& picture, uint32_t space);

// The smaller pictures of a texture (Williams 1983, "Pyramidal Parametrics").

// Appends the smaller pictures of a texture, down to one of a single texel. The texture's own picture is the last one in
// `texels`. Each texel is the mean of the part of the picture before that it covers. Colours of sRGB textures are averaged in
// linear light; alpha, and all of other textures, as plain numbers. Those of bright textures are light already.
void add_smaller_pictures(std::vector<uint32_t>& texels, rt_texture& texture);

}  // namespace clarity::import
