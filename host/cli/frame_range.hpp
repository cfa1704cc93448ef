// frame_range.hpp -- "--frames A-B[/S]".
#pragma once
#include <string>

namespace clarity {

// Frames first, first + step, ... up to last.
struct FrameRange {
    int first = 1, last = 1, step = 1;
    long count() const { return (long(last) - first) / step + 1; }
};
// "5", "1-24", "1-24/2". Throws Error(usage).
FrameRange parse_frame_range(const std::string& text);

}  // namespace clarity
