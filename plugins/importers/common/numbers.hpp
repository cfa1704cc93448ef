// numbers.hpp -- numbers of binary and text files. For importers.
#pragma once
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

namespace importers {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kRadPerDegree = kPi / 180;

// A channel of a colour as screens have it, as linear light. Outside of 0..1 it is limited. IEC 61966-2-1.
inline float linear_of_srgb(double x) {
    if (!(x > 0)) return 0;  // NaN, too
    return static_cast<float>(x >= 1 ? 1 : x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
}

// Reads a number at any address. The caller has checked that its bytes are there.
template <class T>
T load(const char* at, bool big_endian) {
    T value;
    std::memcpy(&value, at, sizeof(T));
    auto* bytes = reinterpret_cast<unsigned char*>(&value);
    if (big_endian) std::reverse(bytes, bytes + sizeof(T));
    return value;
}

// The value in another type; if it does not fit, the nearest value that does. A whole number of NaN is 0.
template <class T, class From>
T nearest(From value) {
    using Limits = std::numeric_limits<T>;
    if constexpr (std::is_floating_point_v<T>) {
        return static_cast<T>(value);
    } else if constexpr (std::is_floating_point_v<From>) {
        if (std::isnan(value)) return 0;
        if (value >= static_cast<From>(Limits::max())) return Limits::max();
        return value <= static_cast<From>(Limits::min()) ? Limits::min() : static_cast<T>(value);
    } else {
        return static_cast<T>(std::clamp<int64_t>(value, Limits::min(), Limits::max()));
    }
}

// Reads one number and moves `at` behind it. "nan", "inf" and numbers beyond a double's are numbers here, and so is
// "-1.#IND", as Microsoft's library writes one that is none. Returns false if there is no number.
inline bool read_number(const char*& at, const char* end, double& number) {
    const char* from = at < end && *at == '+' ? at + 1 : at;
    const std::from_chars_result result = std::from_chars(from, end, number);
    if (result.ptr == from) return false;
    at = result.ptr;
    if (result.ec == std::errc::result_out_of_range) number = *from == '-' ? -HUGE_VAL : HUGE_VAL;
    if (at == end || *at != '#') return true;
    const auto is_letter_or_digit = [](char c) { return (c >= '0' && c <= '9') || ((c | 0x20) >= 'a' && (c | 0x20) <= 'z'); };
    for (++at; at < end && is_letter_or_digit(*at);) ++at;
    number = std::numeric_limits<double>::quiet_NaN();
    return true;
}
// Likewise for a whole number, without a fraction or an exponent.
inline bool read_number(const char*& at, const char* end, int64_t& number) {
    const char* from = at < end && *at == '+' ? at + 1 : at;
    const std::from_chars_result result = std::from_chars(from, end, number);
    const bool goes_on = result.ptr < end && (*result.ptr == '.' || *result.ptr == 'e' || *result.ptr == 'E');
    if (result.ec != std::errc() || goes_on) return false;
    at = result.ptr;
    return true;
}

}  // namespace importers
