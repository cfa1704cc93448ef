#include "ui/widgets/formats.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

namespace clarity::ui {
namespace {

char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
}

}  // namespace

std::string number_text(double value) {
    char text[48];
    std::snprintf(text, sizeof text, value == std::floor(value) && std::abs(value) < 1e15 ? "%.0f" : "%.6g", value);
    return text;
}

std::string count_text(double count) {
    char text[48];
    if (count >= 1e9)
        std::snprintf(text, sizeof text, "%.2f G", count / 1e9);
    else if (count >= 1e6)
        std::snprintf(text, sizeof text, "%.2f M", count / 1e6);
    else if (count >= 1e4)
        std::snprintf(text, sizeof text, "%.1f k", count / 1e3);
    else
        std::snprintf(text, sizeof text, "%.0f", count);
    return text;
}

std::string bytes_text(double bytes) {
    char text[48];
    if (bytes >= 1024.0 * 1024 * 1024)
        std::snprintf(text, sizeof text, "%.2f GiB", bytes / (1024.0 * 1024 * 1024));
    else if (bytes >= 1024.0 * 1024)
        std::snprintf(text, sizeof text, "%.1f MiB", bytes / (1024.0 * 1024));
    else if (bytes >= 1024.0)
        std::snprintf(text, sizeof text, "%.1f KiB", bytes / 1024.0);
    else
        std::snprintf(text, sizeof text, "%.0f B", bytes);
    return text;
}

std::string time_text(double ms) {
    char text[48];
    if (ms >= 10000)
        std::snprintf(text, sizeof text, "%.1f s", ms / 1000);
    else
        std::snprintf(text, sizeof text, ms < 10 ? "%.2f ms" : "%.1f ms", ms);
    return text;
}

std::string file_name(const std::string& path) {
    return path.substr(path.find_last_of('/') + 1);
}

bool matches(const std::string& text, const std::string& filter) {
    std::istringstream words(filter);
    for (std::string word; words >> word;)
        if (std::search(text.begin(), text.end(), word.begin(), word.end(),
                        [](char a, char b) { return lower(a) == lower(b); }) == text.end())
            return false;
    return true;
}

}  // namespace clarity::ui
