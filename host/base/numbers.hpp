// numbers.hpp -- numbers in words, and back, whatever the locale.
#pragma once
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <type_traits>

namespace clarity {

// The shortest text that reads back as the same number.
template <class Number>
std::string exact_text(Number value) {
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// Whether all of `text` is one number, a finite one of that type; else `value` is whatever it is.
template <class Number>
bool read_number(std::string_view text, Number& value) {
    const char* const end = text.data() + text.size();
    const auto [next, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || next != end) return false;
    if constexpr (std::is_floating_point_v<Number>) return std::isfinite(value);
    return true;
}

// The double that prints as the float does: 0.1, not 0.10000000149011612.
inline double short_double(float value) {
    double result = value;
    read_number(exact_text(value), result);
    return result;
}

}  // namespace clarity
