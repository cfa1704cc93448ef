// regular_scenes.hpp -- scenes that hurt: tessellations whose edges and corners lie on planes of cells and of splits, and other
// shapes that make trees deep, uneven or full of copies.
#pragma once
#include <string>
#include <vector>

#include "check/scenes.hpp"

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

}  // namespace clarity::check
