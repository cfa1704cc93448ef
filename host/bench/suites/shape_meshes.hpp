// shape_meshes.hpp -- the shapes of the suite `shapes` as meshes: those of scenes/shapes, in any number of parts around their
// axis.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace clarity::bench {

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
