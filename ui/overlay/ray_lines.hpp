// ray_lines.hpp -- the rays behind a pixel as lines in the scene.
#pragma once
#include <string>
#include <vector>

#include "render/frame/inspect.hpp"
#include "ui/overlay/line_list.hpp"
#include "ui/viewport/projection.hpp"

namespace clarity::ui {

// What the legend says of a kind of ray, in the order that it lists them.
struct RayKind {
    const char* name;
    uint32_t color;
};
// Camera, mirror, refracted, light, shadow: the last two are shadow rays that reach their light, and those that do not.
const std::vector<RayKind>& ray_kinds();
// Index into ray_kinds().
size_t kind_of(const RayRecord& ray);

// Rays that were traced, up to what they met, or for `far` where they met nothing; stubs of those that were not followed. Dots
// at hits. `seen` sizes dots and heads, which look the same from anywhere. selected: index of a ray that stands out; -1: none.
void append_ray_lines(const RayTree& tree, const Projection& seen, float far, float scale, int selected, LineList& lines);

}  // namespace clarity::ui
