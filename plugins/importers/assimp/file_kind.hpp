// file_kind.hpp -- recognises a file by its first bytes.
#pragma once
#include <cstddef>
#include <cstdint>

namespace assimp_import {

// Returns the certainty, 0..100, that this importer is the right one for a file that starts with these bytes.
int certainty(const uint8_t* head, size_t bytes);

}  // namespace assimp_import
