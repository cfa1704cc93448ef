// render_checks.hpp -- checks the options of `clarity render` before any work is done.
#pragma once
#include <string>

#include "cli/commands.hpp"

namespace clarity {

// Parses "--frames A-B[/S]" and "--frames-of K/N".

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

// The frames that the options ask for: one with number 1, those of --frames, or the share of --frames-of, which may be empty.
// Throws Error(usage).
FrameRange frames_of(const RenderOptions& options);
// Throws Error(usage) for options that cannot be met or do not go together.
void check_render_options(const RenderOptions& options, const Settings& settings, const FrameRange& range);

}  // namespace clarity
