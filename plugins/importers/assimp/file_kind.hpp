// file_kind.hpp -- what a file is by its first bytes, and which of them assimp 5.2 cannot read.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

namespace assimp_import {

// 0..100: certainty that this importer is the right one for a file that starts with these bytes.
int certainty(const uint8_t* head, size_t bytes);

// Empty, or why the file cannot be read and what to do. `head`: at least the first 4 KiB where the file has them; FBX only.
std::string fbx_refusal(const uint8_t* head, size_t bytes);

// The version as the header says it, 7400 for 7.4; 0: none found.
int fbx_version(const uint8_t* head, size_t bytes);

}  // namespace assimp_import
