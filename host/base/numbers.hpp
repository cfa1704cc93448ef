// numbers.hpp -- converts numbers to text and back, independent of the locale.
#pragma once
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <type_traits>

namespace clarity {

// The shortest text that converts back to the same number.
template <class Number>
std::string exact_text(Number value) {
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// Returns true and sets `value` if all of `text` is one finite number of this type. Otherwise `value` is undefined.
template <class Number>
bool read_number(std::string_view text, Number& value) {
    const char* const end = text.data() + text.size();
    const auto [next, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || next != end) return false;
    if constexpr (std::is_floating_point_v<Number>) return std::isfinite(value);
    return true;
}

// The double with the same shortest text as the float: 0.1, not 0.10000000149011612.
inline double short_double(float value) {
    double result = value;
    read_number(exact_text(value), result);
    return result;
}

}  // namespace clarity
