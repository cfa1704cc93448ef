// formats.hpp -- numbers and names as the panel shows them.
#pragma once
#include <string>

namespace clarity::ui {

// "1.2 M", "871 k", "12": for counts. "3.4 MiB": for bytes. "0.42 ms", "81.2 ms", "3.1 s": for milliseconds.
std::string count_text(double count);
std::string bytes_text(double bytes);
std::string time_text(double ms);
std::string number_text(double value);
// "1 light", "3 lights".
std::string plural(size_t count, const std::string& noun);
// The file's name without its folders.
std::string file_name(const std::string& path);
// Whether every word of `filter` is somewhere in `text`, whatever its case (of ASCII).
bool matches(const std::string& text, const std::string& filter);

}  // namespace clarity::ui
