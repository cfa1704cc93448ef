// frame_range.hpp -- parses "--frames A-B[/S]" and "--frames-of K/N".
#pragma once
#include <string>

namespace clarity {

// The frames first, first + step, ... up to last. Empty if first > last.
struct FrameRange {
    int first = 1, last = 1;
    long step = 1;
    long count() const { return last < first ? 0 : (long(last) - first) / step + 1; }
};
// Parses "5", "1-24" or "1-24/2". Throws Error(usage).
FrameRange parse_frame_range(const std::string& text);

// Every N-th frame of a range, from its K-th on: the share of one of N processes, "K/N" with K from 1. Empty if there are fewer
// than K frames. Throws Error(usage).
FrameRange share_of_frames(const FrameRange& all, const std::string& text);

}  // namespace clarity
