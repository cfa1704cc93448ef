// deformation.hpp -- what moves the vertices of a mesh at one time: numbers, from which vertices are made by deform.hpp on the
// host, or by moving/on_device/device_deformer.hpp on a device.
#pragma once
#include <vector>

#include "scene/motion/node_transform.hpp"

namespace clarity {

// The vertices are those of two vertex frames, or those at rest. Shares of morph targets are added, then bones move them.
struct Deformation {
    struct TargetShare {
        rt_u32 target = 0;  // of Motion::morph_targets
        double share = 0;   // of its offsets; not 0
        bool operator==(const TargetShare& b) const { return target == b.target && share == b.share; }
    };
    rt_u32 mesh = 0;
    rt_u32 frames = RT_NONE;                     // of Motion::frames; RT_NONE: the mesh has none
    uint64_t frame_before = 0, frame_after = 0;  // within them
    double frame_share = 0;                      // of the second one: 0 to 1
    std::vector<TargetShare> targets;            // ascending
    rt_u32 skin = RT_NONE;                       // of Motion::skins; RT_NONE: none acts
    std::vector<Matrix> bones;                   // for each bone of the skin: where the mesh as bound to it is now
    Matrix unweighted = kIdentityMatrix;         // the same for vertices without weights

    bool operator==(const Deformation& b) const {
        return mesh == b.mesh && frames == b.frames && frame_before == b.frame_before && frame_after == b.frame_after &&
               frame_share == b.frame_share && targets == b.targets && skin == b.skin && bones == b.bones &&
               unweighted == b.unweighted;
    }
};

// What moves the deforming meshes of a scene at one time.
struct Deformers {
    std::vector<PlacedNode> nodes;      // one for each node of the scene
    std::vector<double> morph_weights;  // one for each morph
    double time_s = 0;                  // for vertex frames
};
// Of the meshes of a scene that have frames, morphs or a skin, in their order.
std::vector<Deformation> deformations(const Scene& scene, const Deformers& deformers);

}  // namespace clarity
