// deform.hpp -- makes the vertices of meshes that deform, on the host.
#pragma once
#include "scene/motion/pose.hpp"

namespace clarity {

// The vertices of a mesh as its file has them, 3 numbers each: what skins and morphs start from. In the scene, or in its motion
// if deform_at_rest() has changed those of the scene.
struct StoredVertices {
    const float* positions;
    const float* normals;  // nullptr: the scene has none
};
StoredVertices stored_vertices(const Scene& scene, rt_u32 mesh);
PosedMesh stored_mesh(const Scene& scene, rt_u32 mesh);
// Computes normals from positions: the mean of those of the triangles around a vertex, weighted by area. Vertices that have
// none at rest keep none.
void renew_normals(const Scene& scene, PosedMesh& mesh);

// The vertices of one mesh of a scene at rest.
PosedMesh deformed(const Scene& scene, const Deformation& deformation);

}  // namespace clarity
