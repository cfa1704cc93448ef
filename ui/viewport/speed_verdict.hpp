// speed_verdict.hpp -- decides from measured frame times which of two sides is faster.
#pragma once
#include <string>
#include <vector>

namespace clarity::ui {

inline constexpr const char* kAboutTheSame = "about the same";

// Returns "1.80x faster" if `mine` is faster than `others`, and kAboutTheSame if the difference is within the spread of the
// times. Returns an empty text for the slower side, and if a side has fewer than five times. Times are milliseconds of frames
// that the two sides trace alternately.
std::string speed_verdict(const std::vector<float>& mine, const std::vector<float>& others);

}  // namespace clarity::ui
