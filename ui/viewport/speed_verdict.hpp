// speed_verdict.hpp -- which of two sides is faster, as far as the measured times can tell.
#pragma once
#include <string>
#include <vector>

namespace clarity::ui {

inline constexpr const char* kAboutTheSame = "about the same";

// "1.80x faster" than `others`, kAboutTheSame where the difference is within the spread of the times; empty for the slower
// side, and as long as a side has fewer than five times. In milliseconds, of frames that the two sides trace in turns.
std::string speed_verdict(const std::vector<float>& mine, const std::vector<float>& others);

// The middle one of the values; 0 of none.
double median_of(std::vector<float> values);

}  // namespace clarity::ui
