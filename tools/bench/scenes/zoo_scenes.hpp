// zoo_scenes.hpp -- scenes of the suite zoo that are computed: what is hard for one structure is easy for another.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace clarity::bench {

// Adds to a scene, which may be empty, about so many triangles. The same on all machines. name: stadium, hair, city, height
// field or soup (stand/made_scenes.hpp). Throws std::out_of_range for another name.
void add_zoo_scene(const std::string& name, uint64_t triangles, Scene& scene);

// The shapes of the suite `shapes` as meshes: those of scenes/shapes, in any number of parts around their
// axis.

struct MeshedShape {
    const char* name;             // of the file scenes/shapes/NAME.scene, and of the mesh
    std::vector<unsigned> parts;  // of its meshes, around the axis; ascending
};
const std::vector<MeshedShape>& meshed_shapes();
std::string shape_mesh_name(const std::string& name, unsigned parts);  // "torus, 32 parts"

// The error of a mesh: the greatest distance between the middle of an edge and the point of the surface there. 0: of other
// names.
double shape_mesh_error(const std::string& name, unsigned parts);
// Adds the mesh. Throws std::out_of_range for another name. Returns its error.
double add_shape_mesh(const std::string& name, unsigned parts, Scene& scene);

}  // namespace clarity::bench
