// formats.hpp -- numbers and names as text for the panel.
#pragma once
#include <string>

#include "base/text.hpp"

namespace clarity::ui {

// Counts: "1.2 M", "871 k", "12". Bytes: "3.4 MiB". Milliseconds: "0.42 ms", "81.2 ms", "3.1 s".
std::string count_text(double count);
std::string bytes_text(double bytes);
std::string time_text(double ms);
std::string number_text(double value);
// The file's name without its folders.
std::string file_name(const std::string& path);
// Whether `text` contains every word of `filter`. Case is ignored for ASCII letters.
bool matches(const std::string& text, const std::string& filter);

}  // namespace clarity::ui
