// lower.hpp -- text in lower case, independent of the locale.
#pragma once
#include <string>

namespace clarity {

// Changes only the letters A to Z.
inline char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
inline std::string lower(std::string text) {
    for (char& c : text) c = lower(c);
    return text;
}

}  // namespace clarity
