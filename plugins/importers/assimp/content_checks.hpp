// content_checks.hpp -- finds damage in a file, with its place, because assimp's messages have none.
#pragma once
#include <string>
#include <string_view>

namespace assimp_import {

// Looks for damage that no reader could ignore, before assimp reads the file: XML that is not well-formed, chunks of 3DS that
// are larger than what holds them. extension: lower case, without dot. Returns an empty string, or for example "line 3, column
// 7: found '</mesh>', expected '</source>', which ends the element of line 2".
std::string damage_in(std::string_view bytes, const std::string& extension);

// Says why assimp refused the file, with a place if one can be found. message: what assimp said.
std::string explain_refusal(std::string_view bytes, const std::string& extension, const std::string& message);

}  // namespace assimp_import
