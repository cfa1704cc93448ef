// zoo_scenes.hpp -- scenes of the suite zoo that are computed: what is hard for one structure is easy for another.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace clarity::bench {

// Adds to a scene, which may be empty, about so many triangles. The same on all machines.
//   stadium       tiers and a field around what is there, 200 times as wide: a little detail in much space
//   hair          strands on a ball, each 400 times as long as wide, in all directions
//   city          four kinds of houses, placed in 40 x 40 lots as instances
//   height field  a square of hills, one height for each of k x k points
//   soup          triangles of all directions, at random in a cube, which overlap
// Throws std::out_of_range for another name.
void add_zoo_scene(const std::string& name, uint64_t triangles, Scene& scene);

// The shapes of the suite `shapes` as meshes: those of scenes/shapes, in any number of parts around their
// axis.

struct MeshedShape {
    const char* name;             // of the file scenes/shapes/NAME.scene, and of the mesh
    std::vector<unsigned> parts;  // of its meshes, around the axis; ascending
};
const std::vector<MeshedShape>& meshed_shapes();

// The error of a mesh: the greatest distance between the middle of an edge and the point of the surface there. 0: of other
// names.
double shape_mesh_error(const std::string& name, unsigned parts);
// Adds the mesh. Throws std::out_of_range for another name. Returns its error.
double add_shape_mesh(const std::string& name, unsigned parts, Scene& scene);

}  // namespace clarity::bench
