// printable.hpp -- text that is safe on a terminal. File names and messages of libraries may hold control characters, with
// which a hostile file could rewrite the screen, change the window's title or hide a warning.
#pragma once
#include <string>
#include <string_view>

namespace clarity {

// `text` with every control character and every byte that is no valid UTF-8 written as \xNN. Line feeds and tabs stay.
std::string printable(std::string_view text);
// The same for text that must stay on one line: line feeds and tabs are written as \xNN too.
std::string printable_line(std::string_view text);

// printf to stdout, made printable. All text for people goes to stdout through this function; JSON does not need it.
[[gnu::format(printf, 1, 2)]] void print_text(const char* format, ...);

}  // namespace clarity
