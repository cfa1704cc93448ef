// path_lines.hpp -- draws paths of light as lines in the scene.
#pragma once
#include <vector>

#include "render/tracers/replay/replay.hpp"
#include "ui/overlay/line_list.hpp"
#include "ui/overlay/projection.hpp"

namespace clarity::ui {

// Appends the paths of these samples, from the camera to each event, and from there to the light that counted; light beyond
// everything has a line of length `far`. Paths have the colours of ray_kinds(). seen: as of append_ray_lines(). selected: index
// in `samples` of the highlighted path; -1: none.
void append_path_lines(const Replay& replay, const std::vector<unsigned>& samples, const Projection& seen, float far,
                       float scale, int selected, LineList& lines);

}  // namespace clarity::ui
