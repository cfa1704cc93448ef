// pose.hpp -- a scene at one time of one clip.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "scene/motion/deformation.hpp"
#include "scene/scene.hpp"

namespace clarity {

struct PosedInstance {
    rt_u32 mesh = 0;
    Affine world_from_object = kIdentity;
    bool visible = true;
};
// The vertices of a mesh that deforms, in the space of its instances.
struct PosedMesh {
    rt_u32 mesh = 0;
    std::vector<float> positions;  // 3 for each vertex
    std::vector<float> normals;    // 3 for each vertex, not unit, or (0,0,0); empty if the scene has none
};
// What differs from the scene at rest.
struct Pose {
    std::vector<PosedInstance> instances;  // one for each of the scene
    std::vector<Camera> cameras;           // likewise
    std::vector<Light> lights;             // likewise
    // Of meshes that deform only. Where `meshes` lacks one that has a deformation, its vertices were left out.
    std::vector<PosedMesh> meshes;
    std::vector<Deformation> deformations;
};
// A scene where it is: its instances, cameras and lights.
Pose pose_at_rest(const Scene& scene);
// The deformation of a mesh whose vertices were left out; nullptr: it has none, or its vertices are there.
const Deformation* left_out(const Pose& pose, rt_u32 mesh);
// The meshes that deform, ascending.
std::vector<rt_u32> deforming_meshes(const Pose& pose);

// A clip as users name it: all clips of one name, which play together.
struct ClipInfo {
    std::string name;
    double begin_s = 0, end_s = 0;
    double fps = 0;                           // frames a second; 0: the file does not say
    rt_u32 nodes = 0, skins = 0, morphs = 0;  // that it moves
};
// The clips of a scene, in the order of its files. Files that lack a clip of the name play their first one.
std::vector<ClipInfo> clips(const Scene& scene);

// For each instance: whether a clip moves or shows it, or its mesh deforms.
std::vector<bool> moving_instances(const Scene& scene);
// The same of one clip, which there must be.
std::vector<bool> moving_instances(const Scene& scene, const std::string& clip);

// Reads the vertices of one file of a FileSequence: 3 numbers for each vertex of all its meshes, in their order. May throw
// Error.
using FrameVertices = std::function<std::vector<float>(const std::string& file)>;

// The pose of a clip at a time in seconds of its own clock. clip: a name; empty: the first one. Skins act also if there is no
// clip. The result depends on the arguments, and the files of sequences, alone. Without `read`, sequences stay at rest. Throws
// Error(usage) if the scene has no clip of this name, and Error(import_failed) if a file of a sequence has other meshes.
Pose evaluate(const Scene& scene, const std::string& clip, double time_s, const FrameVertices& read = {});
// The same, but vertices are left out that follow from a deformation; those of sequences are there.
Pose evaluate_without_vertices(const Scene& scene, const std::string& clip, double time_s, const FrameVertices& read = {});
// Computes the vertices that were left out of a pose. scene: at rest.
void add_vertices(const Scene& scene, Pose& pose);

// Moves the vertices of meshes as their skins and the weights of their morphs do without a clip, and places what skins move.
// The scene at rest then looks as its file says. The vertices of the file stay in the motion. as_stored: the meshes that are
// left as they are. Returns how many others were left, because a vertex would not be usable. For a scene which no transform has
// been baked into.
size_t deform_at_rest(Scene& scene, const std::vector<bool>& as_stored);

// Returns the scene in a pose. Its arrays keep their order. If the pose makes the transform of an instance flat, a flat copy of
// its mesh is appended to the meshes. Vertices that the pose leaves out stay at rest. The result has no motion; the instances
// of moving_instances(), and those that were marked before, are marked to be kept apart.
Scene posed(Scene scene, const Pose& pose);

}  // namespace clarity
