// log_rows.hpp -- the log as rows to draw: filtered, with places in source files marked.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "ui/session/log_buffer.hpp"

namespace clarity::ui {

// A place in a source file within a line: "file.cl:12" or "file.cl:12:3".
struct SourcePlace {
    size_t begin = 0, end = 0;
    std::string file;  // as written in the line
    int line = 0;
};
// Returns the first place in the text: a name with an extension, a colon and a number. nullopt if there is none.
std::optional<SourcePlace> find_source_place(const std::string& text);

// Which entries to show: those of at least this level which contain all words.
struct LogFilter {
    LogLevel least = LogLevel::info;
    std::string words;
};

struct LogRow {
    LogLevel level = LogLevel::info;
    std::string text;
    bool place = false;   // the row is a "file:line", which a click copies
    bool inside = false;  // the row continues the row before it
    bool first = false;   // the first row of its entry
};
// Makes the rows of the lines that pass the filter. A line that begins with a place becomes two rows: the place and the
// message.
std::vector<LogRow> log_rows(const std::vector<LogLine>& lines, const LogFilter& filter);

}  // namespace clarity::ui
