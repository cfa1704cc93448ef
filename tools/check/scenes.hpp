// scenes.hpp -- the scenes on which structures are checked. They are made by formula: the same on every machine. A seed other
// than 0 moves what is random in them.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "stand/made_scenes.hpp"
#include "stand/ray_sets.hpp"

namespace clarity::check {

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

// Shells around the origin of sizes from 8 down to 1e-7: a tree that is deeper than any other of the checks' scenes, in a group
// of its own.
Instance& place_shells(SceneMaker& make, const Affine& world_from_object);

// What other scenes hold so that their programs are those of the mixed scene: a sphere, a polygon, and the shells, because
// structures define the size of their stack by the deepest tree. No ray sees these shells; hits.nested sees those of the mixed
// scene. All lie within 1e-4 of the point `at`, in its plane across y, and rays are not aimed there.
void add_common_part(SceneMaker& make, const Point& at);

}  // namespace clarity::check
