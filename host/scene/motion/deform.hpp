// deform.hpp -- vertices of meshes that deform: vertex frames or the mesh at rest, then morphs, then the skin.
#pragma once
#include <vector>

#include "scene/motion/node_transform.hpp"
#include "scene/motion/pose.hpp"

namespace clarity {

// What moves the deforming meshes of a scene at one time.
struct Deformers {
    std::vector<PlacedNode> nodes;      // one for each node of the scene
    std::vector<double> morph_weights;  // one for each morph
    double time_s = 0;                  // for vertex frames
};

// A mesh as the scene has it.
PosedMesh at_rest(const Scene& scene, rt_u32 mesh);
// Computes normals from positions: the mean of those of the triangles around a vertex, weighted by area. Vertices that have
// none at rest keep none.
void renew_normals(const Scene& scene, PosedMesh& mesh);

// The meshes of a scene that have frames, morphs or a skin.
std::vector<PosedMesh> deform(const Scene& scene, const Deformers& deformers);

}  // namespace clarity
