// abi_struct.hpp -- least sizes of the structs that a plugin writes, and copies of such structs in the host's own size.
//
// A plugin may be older or younger than this host, so its structs may be shorter or longer than ours. Everything that the host
// reads of a plugin goes through these copies: what a plugin did not write reads as zero, and what we do not know is left out.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>

#include "base/problem.hpp"
#include "rt_device.h"
#include "rt_plugin.h"
#include "rt_refit.h"

namespace clarity {

// Size of a struct in the first release of ABI version 2, which every plugin of that version has at least. These numbers never
// change. tests/frozen_abi compares them with the header of that release.
template <class T>
inline constexpr uint32_t kLeastBytes = 0;
template <>
inline constexpr uint32_t kLeastBytes<rt_plugin> = 88;
template <>
inline constexpr uint32_t kLeastBytes<rt_accel> = 112;
template <>
inline constexpr uint32_t kLeastBytes<rt_importer> = 32;
template <>
inline constexpr uint32_t kLeastBytes<rt_param> = 64;
template <>
inline constexpr uint32_t kLeastBytes<rt_slot> = 24;
template <>
inline constexpr uint32_t kLeastBytes<rt_extension> = 24;
template <>
inline constexpr uint32_t kLeastBytes<rt_mesh> = 104;
template <>
inline constexpr uint32_t kLeastBytes<rt_instance_desc> = 72;
template <>
inline constexpr uint32_t kLeastBytes<rt_material_desc> = 72;
template <>
inline constexpr uint32_t kLeastBytes<rt_texture_desc> = 40;
template <>
inline constexpr uint32_t kLeastBytes<rt_camera> = 56;
template <>
inline constexpr uint32_t kLeastBytes<rt_light_desc> = 56;
template <>
inline constexpr uint32_t kLeastBytes<rt_load> = 88;
template <>
inline constexpr uint32_t kLeastBytes<rt_scene_info> = 32;

// Shapes came after the first release, in these sizes.
template <>
inline constexpr uint32_t kLeastBytes<rt_primitive> = 64;
template <>
inline constexpr uint32_t kLeastBytes<rt_key> = 64;
template <>
inline constexpr uint32_t kLeastBytes<rt_primitive_desc> = 40;

// Motion came later, too.
template <>
inline constexpr uint32_t kLeastBytes<rt_node_desc> = 400;
template <>
inline constexpr uint32_t kLeastBytes<rt_clip_desc> = 48;
template <>
inline constexpr uint32_t kLeastBytes<rt_channel_desc> = 80;
template <>
inline constexpr uint32_t kLeastBytes<rt_skin_desc> = 48;
template <>
inline constexpr uint32_t kLeastBytes<rt_morph_desc> = 40;
template <>
inline constexpr uint32_t kLeastBytes<rt_vertex_frames> = 32;

// So did skies.
template <>
inline constexpr uint32_t kLeastBytes<rt_sky_desc> = 64;

// Extensions have sizes of their own.
template <>
inline constexpr uint32_t kLeastBytes<rt_refit> = 16;
template <>
inline constexpr uint32_t kLeastBytes<rt_device_build> = 64;

// More than any struct of the ABI will have, and far less than a random word is likely to hold.
inline constexpr uint32_t kMostBytes = 4096;

// Returns nothing if `bytes` may be the size of a T of version 2, otherwise what was found, what is expected and what to
// do. what: the struct's name, "rt_accel". field: the field that tells the size.
template <class T>
Problem check_bytes(const char* what, uint32_t bytes, const char* field = "struct_bytes") {
    static_assert(kLeastBytes<T> > 0 && sizeof(T) >= kLeastBytes<T> && alignof(T) == 8);
    if (bytes >= kLeastBytes<T> && bytes <= kMostBytes && bytes % 8 == 0) return {};
    return std::string(what) + " has " + field + " " + std::to_string(bytes) + ", ABI version " +
           std::to_string(RT_ABI_VERSION) + " has " + std::to_string(kLeastBytes<T>) +
           " or, of a newer SDK, more: write sizeof(" + what + ") there and rebuild the plugin against this SDK";
}

// Copies `bytes` of a struct, or as many as this host knows. The rest is zero.
template <class T>
T copied(const void* from, uint32_t bytes) {
    T copy{};
    std::memcpy(&copy, from, std::min<size_t>(bytes, sizeof(T)));
    return copy;
}

}  // namespace clarity
