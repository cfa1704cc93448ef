// deform.hpp -- makes the vertices of meshes that deform, on the host.
#pragma once
#include "scene/motion/pose.hpp"

namespace clarity {

// A mesh as the scene has it.
PosedMesh at_rest(const Scene& scene, rt_u32 mesh);
// Computes normals from positions: the mean of those of the triangles around a vertex, weighted by area. Vertices that have
// none at rest keep none.
void renew_normals(const Scene& scene, PosedMesh& mesh);

// The vertices of one mesh of a scene at rest.
PosedMesh deformed(const Scene& scene, const Deformation& deformation);

}  // namespace clarity
