// json_text.hpp -- checks the syntax of a JSON text (RFC 8259), and says where it is wrong.
//
// The library that parses it afterwards would also refuse it, but in its own words, and it does not limit how deep arrays and
// objects are nested.
#pragma once
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace gltf_import {

// The file is wrong. The text says where and why, without the file's name.
struct Error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Returns the text for a message: shortened, printable, in quotes.
std::string in_quotes(std::string_view text);

// Throws Error, for example "line 3, column 7 (byte 52): found '}', expected a value". first_byte: where the text begins in the
// file.
void check_json(std::string_view text, size_t first_byte);

}  // namespace gltf_import
