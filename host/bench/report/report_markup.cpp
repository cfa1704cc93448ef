#include "bench/report/report_markup.hpp"

#include <algorithm>
#include <cmath>

#include "bench/output/text_table.hpp"

namespace clarity::bench {
namespace {

// Length in bytes of the UTF-8 character at `at`; 0 if it is none, or if XML forbids it.
size_t character_bytes(const std::string& text, size_t at) {
    const auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
    const unsigned first = byte(at);
    if (first < 0x80) return first >= 0x20 && first != 0x7f ? 1 : first == '\t' || first == '\n' ? 1 : 0;
    const size_t bytes = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
    if (first < 0xc2 || first > 0xf4) return 0;
    unsigned code = first & (0x7fu >> bytes);
    for (size_t i = 1; i < bytes; ++i) {
        if ((byte(at + i) & 0xc0u) != 0x80u) return 0;
        code = code << 6 | (byte(at + i) & 0x3fu);
    }
    const bool overlong = code < (bytes == 2 ? 0x80u : bytes == 3 ? 0x800u : 0x10000u);
    const bool control = code < 0xa0, surrogate = code >= 0xd800 && code < 0xe000, none = (code & 0xfffeu) == 0xfffeu;
    return overlong || control || surrogate || none || code > 0x10ffff ? 0 : bytes;
}

}  // namespace

std::string escape_markup(const std::string& text) {
    std::string out;
    for (size_t at = 0; at < text.size();) {
        const size_t bytes = character_bytes(text, at);
        const char c = text[at];
        if (bytes == 0)
            out += "\xef\xbf\xbd";
        else if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '"')
            out += "&quot;";
        else
            out.append(text, at, bytes);
        at += bytes == 0 ? 1 : bytes;
    }
    return out;
}

std::string figure(double value) {
    if (!std::isfinite(value)) return {};
    if (value == 0) return "0";
    std::string text = short_number(value);
    const size_t point = std::min(text.find('.'), text.size()), first = text[0] == '-' ? 1 : 0;
    if (point - first > 4)
        for (size_t at = point; at > first + 3; at -= 3) text.insert(at - 3, "\u202f");
    return text;
}

std::string tick_figure(double value) {
    std::string text = figure(value);
    if (text.find('.') == std::string::npos) return text;
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
}

std::string percent_figure(double share) {
    return figure(100 * share) + " %";
}

std::string paragraph(const std::string& text) {
    return "<p>" + escape_markup(text) + "</p>\n";
}

std::string MarkupTable::markup() const {
    if (rows_.empty()) return {};
    std::vector<bool> used(head_.size(), false);
    for (const auto& row : rows_)
        for (size_t c = 0; c < row.size() && c < used.size(); ++c)
            if (!row[c].empty()) used[c] = true;
    const auto line = [&](const std::vector<std::string>& row, const char* tag) {
        std::string out = "<tr>";
        for (size_t c = 0; c < head_.size(); ++c) {
            if (!used[c]) continue;
            out += std::string("<") + tag + (c < left_ ? ">" : " class=\"n\">");
            out += escape_markup(c < row.size() ? row[c] : std::string()) + "</" + tag + ">";
        }
        return out + "</tr>\n";
    };
    std::string out = "<div class=\"wide\"><table>\n<thead>" + line(head_, "th") + "</thead>\n<tbody>\n";
    for (const auto& row : rows_) out += line(row, "td");
    return out + "</tbody></table></div>\n";
}

}  // namespace clarity::bench
