// render_checks.hpp -- checks the options of `clarity render` before any work is done.
#pragma once
#include "cli/commands.hpp"
#include "cli/render/frame_range.hpp"

namespace clarity {

// The frames that the options ask for: one with number 1, those of --frames, or the share of --frames-of, which may be empty.
// Throws Error(usage).
FrameRange frames_of(const RenderOptions& options);
// Throws Error(usage) for options that cannot be met or do not go together.
void check_render_options(const RenderOptions& options, const Settings& settings, const FrameRange& range);

}  // namespace clarity
