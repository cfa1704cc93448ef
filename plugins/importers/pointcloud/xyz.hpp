// xyz.hpp -- reads points as text: a line for each with x, y, z, and perhaps an intensity, a colour, a normal.
#pragma once
#include "../openmesh/readers.hpp"

namespace pointcloud {

// Adds a vertex for each point, with a colour if lines have one. Throws std::runtime_error with line and reason.
void read_xyz(const openmesh_import::Source& source, openmesh_import::FlatMesh& mesh);

}  // namespace pointcloud
