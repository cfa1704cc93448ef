// printable.hpp -- makes text safe for a terminal. File names and messages of libraries may contain control characters. With
// them a hostile file could rewrite the screen, change the window's title or hide a warning.
#pragma once
#include <string>
#include <string_view>

namespace clarity {

// Replaces every control character and every byte that is not valid UTF-8 by \xNN. Line feeds and tabs stay.
std::string printable(std::string_view text);
// The same for text that must stay on one line: line feeds and tabs become \xNN too.
std::string printable_line(std::string_view text);
// A printable line for XML and HTML, as text or as the value of an attribute.
std::string markup_line(std::string_view text);

// Like printf, but makes the text printable. All text for people goes to stdout through this function; JSON does not need it.
[[gnu::format(printf, 1, 2)]] void print_text(const char* format, ...);

}  // namespace clarity
