// log.hpp -- the program's log: lines on stderr (and in --log-file, and in the window's log).
#pragma once
#include <functional>
#include <string>

namespace clarity {

enum class LogLevel { debug, info, warning, error };

// Thread-safe. Colour only on a terminal and without NO_COLOR. Control characters of `text` are written as \xNN, on stderr and
// in the file; listeners get the text as it is.
void log(LogLevel level, const std::string& text);
// -q: warning, default: info, -v: debug.
void set_log_level(LogLevel least);
// Throws Error if the file cannot be opened.
void set_log_file(const std::string& path);
// Called with every line of whatever level, from any thread; for the window and tests. Replaces the last one.
void set_log_listener(std::function<void(LogLevel, const std::string&)> listener);

}  // namespace clarity
