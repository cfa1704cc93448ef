#include "diagnostics.hpp"

#include <algorithm>
#include <array>

namespace scene_format {
namespace {

constexpr size_t kMaxShown = 40;     // bytes of the user's text that a message shows at most
constexpr size_t kMaxCompared = 32;  // bytes; longer words are not compared with the keywords

char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

size_t edit_distance(std::string_view a, std::string_view b) {
    // The row before the previous one, the previous row, the current row.
    std::array<std::array<size_t, kMaxCompared + 1>, 3> rows{};
    for (size_t j = 0; j <= b.size(); ++j) rows[1][j] = j;
    for (size_t i = 1; i <= a.size(); ++i) {
        rows[2][0] = i;
        for (size_t j = 1; j <= b.size(); ++j) {
            const bool same = lower(a[i - 1]) == lower(b[j - 1]);
            size_t best = std::min({rows[1][j] + 1, rows[2][j - 1] + 1, rows[1][j - 1] + (same ? 0 : 1)});
            if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1])) {
                best = std::min(best, rows[0][j - 2] + 1);
            }
            rows[2][j] = best;
        }
        rows[0] = rows[1];
        rows[1] = rows[2];
    }
    return rows[1][b.size()];
}

}  // namespace

std::vector<Diagnostic> Diagnostics::errors() const {
    std::vector<Diagnostic> sorted = errors_;
    std::stable_sort(sorted.begin(), sorted.end(), [](const Diagnostic& a, const Diagnostic& b) {
        return a.position.line != b.position.line ? a.position.line < b.position.line : a.position.column < b.position.column;
    });
    return sorted;
}

std::string located(std::string_view file, const Diagnostic& diagnostic) {
    return std::string(file) + ":" + std::to_string(diagnostic.position.line) + ":" +
           std::to_string(diagnostic.position.column) + ": " + diagnostic.message;
}

std::string in_quotes(std::string_view text) {
    if (text.size() <= kMaxShown) return "`" + std::string(text) + "`";
    size_t end = kMaxShown;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // do not cut inside a character
    return "`" + std::string(text.substr(0, end)) + "...`";
}

std::string listed(const std::vector<std::string_view>& words) {
    std::string text;
    for (const std::string_view word : words) {
        if (!text.empty()) text += ", ";
        text += word;
    }
    return text;
}

std::string suggestion(std::string_view read, const std::vector<std::string_view>& words) {
    if (read.empty() || read.size() > kMaxCompared) return {};
    std::string_view nearest;
    size_t nearest_distance = SIZE_MAX;
    for (const std::string_view word : words) {
        if (word.size() > kMaxCompared) continue;
        const size_t distance = edit_distance(read, word);
        // A third of the letters may be wrong: none of `up`, one of `eye`, two of `radius`.
        if (distance <= std::max(read.size(), word.size()) / 3 && distance < nearest_distance) {
            nearest = word;
            nearest_distance = distance;
        }
    }
    return nearest.empty() ? std::string() : "; did you mean `" + std::string(nearest) + "`?";
}

}  // namespace scene_format
