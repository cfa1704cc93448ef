// scenes.hpp -- the scenes on which structures are checked. They are made by formula: the same on every machine. A seed other
// than 0 moves what is random in them.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace clarity::check {

using Point = std::array<float, 3>;

// Region of the mixed scene at which rays are aimed.
struct Region {
    const char* name;
    Point center;
    float radius;
};

// Every kind of primitive, in regions far from each other: a soup, boxes that touch, slanted and flat faces at nearly one
// distance, degenerate triangles, tiny, huge and far-away ones, nested shells, copies at one place, and instances that are
// turned, mirrored, stretched, tiny, large and within each other. About 4000 triangles. One scene, so that one program of each
// lane count does.
Scene mixed_scene(uint64_t seed = 0);
const std::vector<Region>& mixed_regions();
// The mixed scene with other vertices and instances: each region's content moves within it, by up to a third of its radius.
Scene rippled(Scene mixed);

// Small scenes for builders.
struct NamedScene {
    std::string name;
    Scene scene;
};
std::vector<NamedScene> small_scenes(uint64_t seed = 0);

// Triangles that lie apart, so that a bound that is too small is seen: no neighbour covers what it leaves out.
Scene sparse_scene(unsigned count, uint64_t seed = 0);
// `count` triangles of any size in a cube; for tests of time and memory.
Scene soup_scene(unsigned count, uint64_t seed = 0);
// The same far from the origin, besides the pairs of close faces of mixed_scene().
Scene large_scene(unsigned count, uint64_t seed = 0);

}  // namespace clarity::check
