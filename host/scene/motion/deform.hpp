// deform.hpp -- makes the vertices of meshes that deform, on the host.
#pragma once
#include "scene/motion/matrix.hpp"
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

// Rotations and translations that can be blended without a loss of volume, for skins. Kavan, Collins,
// Zara, O'Sullivan (2008), "Geometric Skinning with Approximate Dual Quaternion Blending".

// Scales are kept apart from them, and blended as numbers.
struct DualQuaternion {
    Quaternion real{0, 0, 0, 0}, dual{0, 0, 0, 0};
    Vec scale{};
};

DualQuaternion dual_quaternion(const Matrix& m);
// Adds a share of `d` to a sum.
void add(DualQuaternion& sum, const DualQuaternion& d, double weight);
// The sum need not be of unit length. kIdentityMatrix if it is zero.
Matrix matrix_of(const DualQuaternion& sum);

}  // namespace clarity
