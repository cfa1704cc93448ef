// frame_range.hpp -- parses "--frames A-B[/S]".
#pragma once
#include <optional>
#include <string>

namespace clarity {

// The frames first, first + step, ... up to last.
struct FrameRange {
    int first = 1, last = 1, step = 1;
    long count() const { return (long(last) - first) / step + 1; }
};
// Parses "5", "1-24" or "1-24/2". Throws Error(usage).
FrameRange parse_frame_range(const std::string& text);

// The first frame from the number `from` on; none after the last one. skip: a file name with # for the number; frames whose
// file is there already are left out. Files appear whole, so that one which is there is whole. Empty: none is left out.
std::optional<int> next_frame(const FrameRange& range, long from, const std::string& skip);

}  // namespace clarity
