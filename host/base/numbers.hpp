// numbers.hpp -- converts numbers to text and back, independent of the locale.
#pragma once
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

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

// Reads a share: 0.05, or 5%. As read_number().
template <class Number>
bool read_share(std::string_view text, Number& value) {
    if (text.empty() || text.back() != '%') return read_number(text, value);
    double percent = 0;
    if (!read_number(text.substr(0, text.size() - 1), percent)) return false;
    value = static_cast<Number>(percent / 100);
    return true;
}

// Reads finite numbers with commas between them. Returns an empty list if the text is anything else.
template <class Number>
std::vector<Number> read_numbers(std::string_view text) {
    std::vector<Number> numbers;
    for (;;) {
        const size_t comma = text.find(',');
        Number value{};
        if (!read_number(text.substr(0, comma), value)) return {};
        numbers.push_back(value);
        if (comma == std::string_view::npos) return numbers;
        text.remove_prefix(comma + 1);
    }
}

// The text that read_numbers() reads: all digits.
template <class Number>
std::string numbers_text(const Number* values, size_t count) {
    std::string text;
    for (size_t i = 0; i < count; ++i) text += (i ? "," : "") + exact_text(values[i]);
    return text;
}

// The double with the same shortest text as the float: 0.1, not 0.10000000149011612.
inline double short_double(float value) {
    double result = value;
    read_number(exact_text(value), result);
    return result;
}

}  // namespace clarity
