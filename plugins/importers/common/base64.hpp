// base64.hpp -- bytes that a text file holds as base64. For importers.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace importers {

// Appends the bytes to `out`. Returns the position of the first character that is not base64, or npos.
inline size_t decode_base64(std::string_view text, std::string& out) {
    static const auto values = [] {
        std::array<int8_t, 256> table;
        table.fill(-1);
        constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        for (size_t i = 0; i < digits.size(); ++i) table[static_cast<unsigned char>(digits[i])] = static_cast<int8_t>(i);
        return table;
    }();
    out.reserve(out.size() + text.size() / 4 * 3 + 3);
    uint32_t bits = 0;
    int bit_count = 0;
    for (size_t i = 0; i < text.size(); ++i) {
        const int value = values[static_cast<unsigned char>(text[i])];
        if (value < 0) {
            const size_t rest = text.find_first_not_of('=', i);
            return rest == text.npos && text.size() - i <= 2 ? text.npos : i;
        }
        bits = (bits << 6 | uint32_t(value)) & 0xFFFFFF;
        bit_count += 6;
        if (bit_count < 8) continue;
        bit_count -= 8;
        out += static_cast<char>(bits >> bit_count & 0xFF);
    }
    return text.npos;
}

}  // namespace importers
