// content_checks.hpp -- finds damage in a file that crashes assimp, or that its messages do not explain.
#pragma once
#include <string>
#include <string_view>

namespace assimp_import {

// The text for a message: shortened, printable, in quotes.
std::string in_quotes(std::string_view text);

// Looks for damage before assimp reads the file: what crashes it in XML, and chunks of 3DS that are larger than what holds
// them. extension: lower case, without dot. Returns an empty string, or for example "byte 0: found 'XX', expected 'MM', with
// which a 3DS file begins".
std::string damage_in(std::string_view bytes, const std::string& extension);

// Says why assimp refused the file, with a place if one can be found. message: what assimp said.
std::string explain_refusal(std::string_view bytes, const std::string& extension, const std::string& message);

}  // namespace assimp_import
