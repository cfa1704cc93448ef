// frame_range.hpp -- parses "--frames A-B[/S]".
#pragma once
#include <string>

namespace clarity {

// The frames first, first + step, ... up to last.
struct FrameRange {
    int first = 1, last = 1, step = 1;
    long count() const { return (long(last) - first) / step + 1; }
};
// Parses "5", "1-24" or "1-24/2". Throws Error(usage).
FrameRange parse_frame_range(const std::string& text);

}  // namespace clarity
