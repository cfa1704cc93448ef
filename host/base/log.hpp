// log.hpp -- the program's log: lines on stderr, in the file of --log-file and in the window's log.
#pragma once
#include <functional>
#include <string>

namespace clarity {

enum class LogLevel { debug, info, warning, error };

// Writes a line to the log. Thread-safe. Colours are used only on a terminal and if NO_COLOR is not set. Control characters of
// `text` are written as \xNN on stderr and in the file; the listener gets the text unchanged.
void log(LogLevel level, const std::string& text);
// Sets the lowest level that is written. -q: warning, default: info, -v: debug.
void set_log_level(LogLevel least);
// For libraries: false keeps the log off stderr, so that only the file and the listener get it.
void set_log_to_stderr(bool on);
// Also appends the log to this file. Throws Error if the file cannot be opened.
void set_log_file(const std::string& path);
// Whether the file of the log could not be written, which a warning has said: it ended before the log did.
bool log_file_failed();
// The listener is called with every line of every level, from any thread. It replaces the previous one. For the window and
// tests.
void set_log_listener(std::function<void(LogLevel, const std::string&)> listener);

}  // namespace clarity
