// host_mover.hpp -- a structure that follows the poses of its scene: refitted where primitives moved, as long as the scene
// keeps its meshes and instances.
//
//   HostMover moving(scene, structure);               // of a finished build
//   if (!moving.cannot()) {
//       const MovedStructure moved = moving.move(evaluate(scene, clip, time), progress);
//       if (moved.accel) draw it; else build a new one, for the reason moved.why
//   }
//
// Each result is a finished, immutable structure. Two or three of them exist at a time and are used again and again: one that
// nobody else holds any more is written next. So nothing is allocated from the third move on, and frames may go on with an
// earlier result, on any thread, for as long as they like.
//
// State besides these structures: 12 B a triangle (its vertices, in leaf order) and 12 B a vertex.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "base/progress.hpp"
#include "moving/moved_instances.hpp"
#include "moving/on_host/leaf_packer.hpp"
#include "moving/pose_mover.hpp"
#include "scene/motion/pose.hpp"
#include "scene/scene.hpp"
#include "structures/accel_build.hpp"

namespace clarity {

class HostMover : public PoseMover {
 public:
    // built: the structure of `scene`, which may be in any pose itself.
    HostMover(std::shared_ptr<const Scene> scene, std::shared_ptr<const AccelData> built);
    ~HostMover() override;

    // Why the structure can only be built anew: "accel linear does not offer `refit`"; nothing: it can be refitted.
    const Problem& cannot() const override { return cannot_; }

    // Moves the structure to a pose of the same scene: as evaluate() returns it for the scene that this one is a pose of, or
    // is. Meshes that the pose does not have are where the scene has them. Throws Error(failed) if the plugin fails, and
    // Cancelled; the next move then refits all that this one left. One call at a time.
    MovedStructure move(const Pose& pose, Progress& progress);
    MovedStructure move(const Pose& pose, bool, Progress& progress) override { return move(pose, progress); }

    // The vertices of a mesh in object space, 3 numbers each, to be written in place instead of through a pose: for those who
    // compute them anyway. nullptr: the mesh is flattened into the world by a transform, or is not placed, so that a pose must
    // be used.
    float* vertices(rt_u32 mesh);
    // Says that vertices() of a mesh were written. move() puts the mesh back where its pose has it.
    void touch(rt_u32 mesh);
    // Refits what was touched. As move().
    MovedStructure refit(Progress& progress);

    uint64_t state_bytes() const;  // of everything that the first structure does not have

 private:
    struct Buffer;
    struct Move;

    void find_flat_instances();
    void start(Progress& progress);
    Problem place(const Pose& pose);
    const float* vertices_at_rest(rt_u32 mesh) const;
    void set_vertices(rt_u32 mesh, const float* object);
    void transform_vertices(rt_u32 mesh, const float* object, const Affine* world);
    Buffer& spare();
    void place_instances(AccelData& accel);
    void call(Buffer& buffer, const std::vector<uint8_t>& changed, Progress& progress, MovedStructure& result);
    MovedStructure refit_into_spare(Progress& progress);

    const std::shared_ptr<const Scene> scene_;
    const std::shared_ptr<const AccelData> built_;
    const rt_refit plugin_;
    Problem cannot_;
    ParameterValues params_;
    std::vector<uint64_t> primitives_of_group_;
    UninitializedVector<rt_u32> corners_;
    std::unique_ptr<const GroupOfRef> groups_;

    // The pose.
    std::vector<PosedInstance> instances_;   // of the Scene
    std::vector<Affine> object_from_world_;  // of the structure's instances
    std::vector<Affine> world_from_object_;
    std::vector<rt_u32> hidden_;            // rt_instance::hidden of each
    UninitializedVector<float> positions_;  // in the space of their groups, then one more
    std::vector<Bounds> boxes_;             // of the groups
    std::vector<rt_u32> flat_instance_;     // for each mesh: the instance that flattens it, or RT_NONE
    MovedInstances moved_;
    std::vector<uint8_t> is_posed_, is_deformed_;  // for each mesh: by the pose that is taken over, and by the last one
    std::vector<uint64_t> version_;                // of each group: the number of the move that changed it last
    std::vector<double> cost_, built_cost_;        // of the groups
    uint64_t moves_ = 0;
    std::vector<std::unique_ptr<Buffer>> buffers_;
    bool started_ = false;
};

}  // namespace clarity
