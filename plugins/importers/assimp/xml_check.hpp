// xml_check.hpp -- checks that an XML text is well-formed, and that references and numbers of COLLADA make sense.
#pragma once
#include <string>
#include <string_view>

namespace assimp_import {

// The text for a message: shortened, printable, in quotes.
std::string in_quotes(std::string_view text);

// These return an empty string, or the place, what is there and what should be.
std::string xml_damage(std::string_view text);
// For well-formed texts. Finds what crashes assimp: accessors that reach beyond their array.
std::string collada_accessor_damage(std::string_view text);
// For well-formed texts that assimp has refused: finds why.
std::string collada_damage(std::string_view text);

}  // namespace assimp_import
