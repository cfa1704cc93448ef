#include "base/text.hpp"

#include <cstdarg>
#include <cstdint>
#include <cstdio>

namespace clarity {
namespace {

// Length in bytes of the valid UTF-8 sequence at the start of `text`; 0 if it is invalid (RFC 3629: no overlong forms, no
// surrogates).
size_t utf8_length(std::string_view text) {
    const auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
    const auto continues = [&](size_t i) { return (byte(i) & 0xC0u) == 0x80u; };
    const unsigned first = byte(0), second = byte(1);
    if (first < 0x80) return 1;
    if (first >= 0xC2 && first <= 0xDF) return continues(1) ? 2 : 0;
    if (first >= 0xE0 && first <= 0xEF) {
        const bool overlong = first == 0xE0 && second < 0xA0, surrogate = first == 0xED && second > 0x9F;
        return continues(1) && continues(2) && !overlong && !surrogate ? 3 : 0;
    }
    if (first >= 0xF0 && first <= 0xF4) {
        const bool overlong = first == 0xF0 && second < 0x90, beyond = first == 0xF4 && second > 0x8F;
        return continues(1) && continues(2) && continues(3) && !overlong && !beyond ? 4 : 0;
    }
    return 0;
}

// True for C0, DEL and C1 (U+0080 to U+009F): terminals obey C1 too.
bool is_control(std::string_view text, size_t length) {
    const auto first = static_cast<unsigned char>(text[0]);
    if (length == 1) return first < 0x20 || first == 0x7F;
    return length == 2 && first == 0xC2 && static_cast<unsigned char>(text[1]) < 0xA0;
}

std::string visible(std::string_view text, std::string_view kept) {
    std::string out;
    out.reserve(text.size());
    for (size_t at = 0; at < text.size();) {
        const std::string_view rest = text.substr(at);
        const size_t length = utf8_length(rest);
        const bool keep = kept.find(rest[0]) != std::string_view::npos || (length > 0 && !is_control(rest, length));
        const size_t bytes = length > 0 ? length : 1;
        for (size_t i = 0; i < bytes; ++i) {
            if (keep) {
                out += rest[i];
                continue;
            }
            char code[8];
            std::snprintf(code, sizeof code, "\\x%02x", static_cast<unsigned>(static_cast<unsigned char>(rest[i])));
            out += code;
        }
        at += bytes;
    }
    return out;
}

}  // namespace

std::string printable(std::string_view text) {
    return visible(text, "\n\t");
}

std::string printable_line(std::string_view text) {
    return visible(text, "");
}

std::string markup_line(std::string_view text) {
    std::string out;
    for (const char c : printable_line(text)) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

void print_text(const char* format, ...) {
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    std::string text;
    const int length = std::vsnprintf(nullptr, 0, format, arguments);
    if (length > 0) {
        text.resize(static_cast<size_t>(length) + 1);
        std::vsnprintf(text.data(), text.size(), format, again);
        text.pop_back();
    }
    va_end(again);
    va_end(arguments);
    const std::string shown = printable(text);
    std::fwrite(shown.data(), 1, shown.size(), stdout);
}

std::string memory_text(uint64_t bytes) {
    char text[32];
    const double mebibytes = double(bytes) / (1u << 20);
    if (mebibytes < 1000)
        std::snprintf(text, sizeof text, "%.*f MiB", mebibytes < 10 ? 1 : 0, mebibytes);
    else
        std::snprintf(text, sizeof text, "%.1f GiB", mebibytes / 1024);
    return text;
}

std::string memory_limit_text(uint64_t bytes) {
    const uint64_t mebibytes = bytes >> 20;
    if (mebibytes == 0) return std::to_string(bytes) + " bytes";
    return mebibytes < 10240 ? std::to_string(mebibytes) + " MiB" : std::to_string(mebibytes >> 10) + " GiB";
}

}  // namespace clarity
