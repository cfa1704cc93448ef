// device_mover.hpp -- a structure on a device that follows the poses of its scene there.
//
//   DeviceMover motion(device, scene, structure, on_device, rest);   // of a finished build
//   if (!motion.cannot()) {
//       const MovedOnDevice moved = motion.move(evaluate_without_vertices(rest, clip, time));
//       if (moved.on_device) draw it; else build a new one, for the reason moved.why
//   }
//
// As HostMover, but vertices, leaves, boxes and trees are written by the device that traces them: the host sends transforms
// that have changed, bones and shares of morph targets, and enqueues kernels. It waits for nothing. Commands of earlier frames
// in the device's queue run before those of the move, and commands of later frames after them.
//
// Memory on the device: 24 B a vertex, 12 B and 40 B of scratch a triangle, and up to three copies of leaves and nodes.
#pragma once
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/aligned_bytes.hpp"
#include "base/problem.hpp"
#include "moving/moved_instances.hpp"
#include "moving/on_device/device_deformer.hpp"
#include "moving/on_device/device_structure.hpp"
#include "moving/pose_mover.hpp"
#include "scene/motion/pose.hpp"

namespace clarity {

// `ms` is the time of the call; the device goes on after it. Devices tell costs some moves later.
struct MovedOnDevice : MovedStructure {
    std::shared_ptr<const DeviceScene> on_device;  // nullptr: a full build is needed, for the reason in `why`
    cl::Event begin, end;                          // of the device's work
};

// Used from one thread at a time, which may differ from that of frames.
class DeviceMover {
 public:
    // What is done with the trees of groups that have changed; `build`: only if can_build().
    enum class Update { refit, build };

    // built: the structure of `scene`, which may be in any pose itself. on_device: its buffers. rest: the scene at rest, with
    // its motion; nullptr: vertices are not made on the device. Throws Error.
    DeviceMover(std::shared_ptr<Device> device, std::shared_ptr<const Scene> scene, std::shared_ptr<const AccelData> built,
                std::shared_ptr<const DeviceScene> on_device, std::shared_ptr<const Scene> rest = nullptr,
                BuildForm form = BuildForm::automatic);
    ~DeviceMover();

    // Why the structure can only be built anew: "accel linear does not offer a refit on the device"; nothing: it can follow
    // poses.
    const Problem& cannot() const;

    // Moves the structure to a pose of the same scene, as HostMover::move(). The device makes the vertices that the pose
    // leaves out; others are sent. Throws Error(failed).
    MovedOnDevice move(const Pose& pose, Update update = Update::refit);
    bool can_build() const { return groups_->can_build(); }
    // Whether poses may leave vertices out.
    bool can_deform() const { return can_deform_; }
    // The structure as it was built, but with the defines that trees need which the device builds: what kernels are made for.
    // It changes with the first build only.
    const std::shared_ptr<const AccelData>& accel() const { return accel_; }

    // Where the vertices of the Scene are on the device, 3 floats each, in the space of their groups: for code that computes
    // them there. Null before the first move.
    const cl::Buffer& vertices() const { return pose_.positions; }
    // Says that commands in the device's queue write the vertices of a mesh.
    void touch(rt_u32 mesh);
    // Refits what was touched. As move().
    MovedOnDevice update(Update update = Update::refit);

 private:
    void start();
    Problem place(const Pose& pose);
    void deform(const Pose& pose);
    void set_vertices(rt_u32 mesh, const float* positions, const float* normals);
    void send(const cl::Buffer& to, size_t at, size_t bytes, const void* data);
    DeviceStructure& spare();
    void raise_defines(const std::map<std::string, rt_u32>& defines);
    uint64_t bring_up(DeviceStructure& structure, Update update, bool with_costs);
    void finish_move(Update update, MovedOnDevice& moved);
    const DeviceStructure& with_tree_of(rt_u32 group) const;
    double worst_cost_ratio();
    std::vector<MovedGroup> moved_groups() const;

    const std::shared_ptr<Device> device_;
    const std::shared_ptr<const Scene> scene_;
    const std::shared_ptr<const AccelData> built_;
    const std::shared_ptr<const DeviceScene> on_device_;
    const std::shared_ptr<const Scene> rest_;
    const bool can_deform_;
    BuildKernels kernels_;
    std::shared_ptr<const AccelData> accel_;  // see accel()
    DevicePose pose_;
    std::unique_ptr<DeviceGroups> groups_;

    // The pose, on the host.
    std::vector<PosedInstance> instances_;  // of the Scene
    std::vector<DevicePlacement> placements_;
    MovedInstances moved_;
    UninitializedVector<float> positions_, normals_;  // what was sent last; the device may read it until sent_ is complete
    std::vector<uint8_t> is_posed_, is_deformed_;     // for each mesh: by the pose that is taken over, and by the last one
    std::unique_ptr<DeviceDeformer> deformer_;        // nullptr: not needed yet
    std::map<rt_u32, Deformation> made_by_;           // the meshes whose vertices the device has made
    std::vector<uint64_t> version_;                   // of each group: the number of the move that changed it last
    uint64_t moves_ = 0;
    std::vector<cl::Event> sent_;

    std::vector<uint64_t> built_in_;                           // of each group: the move in which its tree was built
    std::deque<std::unique_ptr<DeviceStructure>> structures_;  // the newest last
    // Of the groups: costs_ is written by the device until costs_known_. A build makes built_costs_ of the next ones.
    std::vector<float> costs_, built_costs_;
    std::vector<double> ratios_;     // the last ones known
    std::vector<uint8_t> is_fresh_;  // of each group: costs_ is that after its build
    cl::Event costs_known_;
    double last_ratio_ = 1;
    bool started_ = false;
};

}  // namespace clarity
