#include "tools/bench/output/text_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace clarity::bench {
namespace {

// Characters on the screen: counts the first byte of each UTF-8 character.
size_t width_of(const std::string& text) {
    return static_cast<size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string cut(const std::string& text, size_t most) {
    return width_of(text) <= most ? text : text.substr(0, most - 2) + "..";
}

}  // namespace

std::string TextTable::text(size_t cell) const {
    const size_t columns = rows_.front().size();
    std::vector<size_t> width(columns, 0);
    for (size_t c = 0; c < columns; ++c) {
        const bool used = std::any_of(rows_.begin() + 1, rows_.end(), [&](const auto& row) { return !row[c].empty(); });
        if (!used) continue;
        for (const auto& row : rows_)
            width[c] = std::max(width[c], c < left_ ? std::min(width_of(row[c]), cell) : width_of(row[c]));
    }
    std::string text;
    for (const auto& row : rows_) {
        std::string line;
        for (size_t c = 0; c < columns; ++c) {
            if (width[c] == 0) continue;
            const std::string shown = c < left_ ? cut(row[c], cell) : row[c];
            const std::string space(width[c] - std::min(width[c], width_of(shown)), ' ');
            line += (line.empty() ? "" : "  ") + (c < left_ ? shown + space : space + shown);
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + "\n";
    }
    return text;
}

std::string decimals(double value, int digits) {
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", digits, value);
    return text;
}

std::string short_number(double value) {
    if (value == 0 || !std::isfinite(value)) return {};
    return decimals(value, std::clamp(2 - static_cast<int>(std::floor(std::log10(std::fabs(value)) + 1e-9)), 0, 4));
}

std::string percent(double share) {
    return decimals(100 * share, 1);
}

}  // namespace clarity::bench
