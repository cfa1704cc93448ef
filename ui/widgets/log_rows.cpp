#include "ui/widgets/log_rows.hpp"

#include <cctype>
#include <sstream>

#include "ui/widgets/formats.hpp"

namespace clarity::ui {
namespace {

bool of_a_name(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == '.' || c == '/' || c == '+' ||
           c == '<' || c == '>' || static_cast<unsigned char>(c) >= 0x80;
}

bool digit(const std::string& text, size_t at) {
    return at < text.size() && std::isdigit(static_cast<unsigned char>(text[at]));
}

size_t after_digits(const std::string& text, size_t at) {
    while (digit(text, at)) ++at;
    return at;
}

}  // namespace

std::optional<SourcePlace> find_source_place(const std::string& text) {
    for (size_t colon = text.find(':'); colon != std::string::npos; colon = text.find(':', colon + 1)) {
        if (!digit(text, colon + 1)) continue;
        size_t begin = colon;
        while (begin > 0 && of_a_name(text[begin - 1])) --begin;
        const std::string file = text.substr(begin, colon - begin);
        const size_t dot = file.rfind('.');
        // The name needs an extension with a letter: "0:0" is a device, "12.5:1" is a ratio.
        if (dot == std::string::npos || dot + 1 >= file.size() || !std::isalpha(static_cast<unsigned char>(file[dot + 1])))
            continue;
        SourcePlace place{begin, after_digits(text, colon + 1), file, 0};
        if (place.end - colon > 8) continue;  // no file has so many lines
        place.line = std::stoi(text.substr(colon + 1, place.end - colon - 1));
        if (place.end < text.size() && text[place.end] == ':' && digit(text, place.end + 1))
            place.end = after_digits(text, place.end + 1);
        return place;
    }
    return std::nullopt;
}

std::vector<LogRow> log_rows(const std::vector<LogLine>& lines, const LogFilter& filter) {
    std::vector<LogRow> rows;
    for (const LogLine& entry : lines) {
        if (entry.level < filter.least || !matches(entry.text, filter.words)) continue;
        std::istringstream text(entry.text);
        bool first = true;
        for (std::string line; std::getline(text, line); first = false) {
            const auto place = find_source_place(line);
            if (!place || place->begin > 0) {
                rows.push_back({entry.level, line, false, false, first});
                continue;
            }
            rows.push_back({entry.level, line.substr(0, place->end), true, false, first});
            const size_t rest = line.find_first_not_of(": ", place->end);
            if (rest != std::string::npos) rows.push_back({entry.level, line.substr(rest), false, true, false});
        }
    }
    return rows;
}

}  // namespace clarity::ui
