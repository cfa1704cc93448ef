// ray_lines.hpp -- draws the rays of a pixel, and the paths of its samples, as lines in the scene.
#pragma once
#include <string>
#include <vector>

#include "tracers/inspect/inspect.hpp"
#include "tracers/replay/replay.hpp"
#include "ui/overlay/line_list.hpp"
#include "ui/overlay/projection.hpp"

namespace clarity::ui {

// The legend's name and colour for a kind of ray.
struct RayKind {
    const char* name;
    uint32_t color;
};
// The kinds in the order of the legend: camera, mirror, refracted, light, shadow. "light" is a shadow ray that reaches its
// light, "shadow" one that does not.
const std::vector<RayKind>& ray_kinds();
// Returns an index into ray_kinds().
size_t ray_kind_of(const RayRecord& ray);

// Appends the traced rays up to their hits, or with length `far` for a miss; short stubs for rays that were not traced; dots at
// hits. seen: view that dots and arrow heads are sized for, so that they look the same from anywhere. selected: index of the
// highlighted ray; -1: none.
void append_ray_lines(const RayTree& tree, const Projection& seen, float far, float scale, int selected, LineList& lines);

// Draws paths of light as lines in the scene.

// Appends the paths of these samples, from the camera to each event, and from there to the light that counted; light beyond
// everything has a line of length `far`. Paths have the colours of ray_kinds(). seen: as of append_ray_lines(). selected: index
// in `samples` of the highlighted path; -1: none.
void append_path_lines(const Replay& replay, const std::vector<unsigned>& samples, const Projection& seen, float far,
                       float scale, int selected, LineList& lines);

}  // namespace clarity::ui
