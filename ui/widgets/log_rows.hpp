// log_rows.hpp -- the log as rows to draw: filtered, with the places in source files found.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "ui/session/log_buffer.hpp"

namespace clarity::ui {

// "file.cl:12" or "file.cl:12:3" within a line.
struct SourcePlace {
    size_t begin = 0, end = 0;
    std::string file;  // as it stands there
    int line = 0;
};
// The first one; none where nothing looks like one: a name with an extension, a colon and a number.
std::optional<SourcePlace> find_source_place(const std::string& text);

struct LogFilter {
    LogLevel least = LogLevel::info;
    std::string words;
};

struct LogRow {
    LogLevel level = LogLevel::info;
    std::string text;
    bool place = false;   // it is "file:line", which a click copies
    bool inside = false;  // it belongs to the row before
    bool first = false;   // of its entry
};
// A line that begins with a place becomes two rows, the place and what is said of it.
std::vector<LogRow> log_rows(const std::vector<LogLine>& lines, const LogFilter& filter);

}  // namespace clarity::ui
