// regular_scenes.hpp -- scenes that hurt: tessellations whose edges and corners lie on planes of cells and of splits, and other
// shapes that make trees deep, uneven or full of copies.
#pragma once
#include <string>
#include <vector>

#include "tools/check/scenes.hpp"

namespace clarity::check {

// One mesh of such a scene.
struct Patch {
    const char* name;
    float size;  // of a square or cube; of others: what is small beside them
};

// All patches, each a mesh with a tree of its own: the world holds only their instances, so meshes are far deeper than it.
// Meshes are in the order of patches().
Scene regular_scene(uint64_t seed = 0);
const std::vector<Patch>& patches();

// Such a scene in another pose: waves of twice a square's size.
Scene bent(Scene regular);

// The first patch alone, a flat floor of 64 x 64 squares from 0 to 10, in the world itself.
Scene floor_scene();

// Meshes of 1 to 20 triangles, each with a tree of its own, and 300 triangles in the world's tree. Another mesh has 300
// triangles. The centres of their boxes are the same, so that no builder can split them by centres. No triangle is close in
// front of another.
Scene sizes_scene(uint64_t seed = 0);

// `count` triangles around the origin, and a room around them. The box of each holds a cube of 0.3 around the origin, but a ray
// from there across (1, 1, 1) meets none of them: it enters all boxes and leaves and hits the room behind them.
Scene crowd_scene(unsigned count);

// `count` pairs of triangles along x, each four times as large and as far away as the one before. So a builder that looks at
// surfaces splits off one pair after the other. A ray from the origin along (1, y, 0.32 - y), y from 0.06 to 0.26, enters all
// boxes, and meets at most one triangle, a pair's small one (row_ray_sets() knows which); one along x meets a large one first.
Scene row_scene(unsigned count);
inline float row_place(unsigned pair, unsigned count) {  // y of the pair's small triangle
    return 0.06f + 0.2f * float(pair) / float(count);
}

}  // namespace clarity::check
