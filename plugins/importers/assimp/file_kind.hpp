// file_kind.hpp -- recognises a file by its first bytes, and tells which FBX files assimp 5.2 cannot read.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

namespace assimp_import {

// Returns the certainty, 0..100, that this importer is the right one for a file that starts with these bytes.
int certainty(const uint8_t* head, size_t bytes);

// Returns an empty string, or why the FBX file cannot be read and what to do. `head` must hold the first 4 KiB, or the whole
// file if it is shorter.
std::string fbx_refusal(const uint8_t* head, size_t bytes);

// Returns the version in the header, for example 7400 for 7.4, or 0 if there is none.
int fbx_version(const uint8_t* head, size_t bytes);

}  // namespace assimp_import
