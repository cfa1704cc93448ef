// binary.hpp -- numbers and records of binary FBX files.
#pragma once
#include "../common/numbers.hpp"
#include "document.hpp"

namespace fbx_import {

using importers::load;

// "Kaydara FBX Binary", two spaces, 0, 0x1A, the byte order (0 little, 1 big), and the version as 32 bits in that order.
// Source: Blender developer blog, "FBX binary file format specification"; the byte order: measured from
// maya_cube_big_endian_7500_binary.
inline constexpr std::string_view kMagic{"Kaydara FBX Binary  \0\x1A", 22};
inline constexpr size_t kVersionAt = 23, kHeaderBytes = 27;

// Nodes within nodes, at most. Files of the shared set nest 8 deep.
inline constexpr int kMaxDepth = 64;
inline constexpr size_t kMaxNodes = size_t(1) << 28;

// Bytes of one element of an array of this type, or of one value; 0: there is no such type. Source: as above.
inline size_t element_bytes(char type) {
    constexpr std::string_view of_8 = "dlDL", of_4 = "fiFI", of_1 = "bcBC";
    const auto is_in = [&](std::string_view types) { return types.find(type) != types.npos; };
    return is_in(of_8) ? 8 : is_in(of_4) ? 4 : type == 'Y' ? 2 : is_in(of_1) ? 1 : 0;
}
inline bool is_array(char type) {
    return type >= 'a' && type <= 'z' && element_bytes(type) != 0;
}

}  // namespace fbx_import
