// run_tool.hpp -- runs another program in front of the user: it shares our terminal, environment and signals.
#pragma once
#include <string>
#include <vector>

namespace clarity {

// Runs words[0], found by PATH, and waits for its end. Returns whether it ended with code 0. Throws Error(failed) if it cannot
// be run; the message calls it `shown`.
bool run_tool(const std::vector<std::string>& words, const std::string& shown);

}  // namespace clarity
