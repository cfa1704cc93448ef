// png_text.hpp -- texts in PNG files: chunks tEXt, and iTXt for texts beyond ASCII (PNG specification, third edition, 11.3.3).
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace clarity {

// Puts texts into an encoded PNG, before its pixels. Keys: 1 to 79 letters, digits or spaces. Values: UTF-8.
void add_png_texts(std::string& png, const std::vector<std::pair<std::string, std::string>>& texts);

}  // namespace clarity
