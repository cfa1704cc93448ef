// wavefront.hpp -- the host's side of cl/tracers/wavefront/wavefront.cl: ray queues on the device, and the order of its
// kernels.
#pragma once
#include <memory>

#include "device/device.hpp"
#include "render/film/growing_buffer.hpp"
#include "render/kernels/kernel_source.hpp"
#include "render/kernels/layout.hpp"
#include "render/launch/launch.hpp"
#include "render/launch/ping_pong.hpp"
#include "render/launch/prepared.hpp"
#include "render/launch/view_buffers.hpp"
#include "render/settings/view.hpp"
#include "scene/scene.hpp"

namespace clarity {

// Work-groups [begin, begin + groups) of one sample of a picture. The caller owns the buffers. Film and distances have the
// layout that trace_iterative uses.
struct WavefrontFrame {
    const Prepared& prepared;
    const View& view;
    const ViewBuffers& view_buffers;
    Layout layout;
    unsigned width, height, begin, groups, depth, sample;
    const cl::Buffer &film, &distances;
};

// Whether a ray may split in two: some material of the view is transparent, or of the scene if the view has none.
bool refracts(const Scene& scene, const std::vector<rt_material>& materials);

// Traces samples with the wavefront tracer. Owns its queues; used from one thread.
class Wavefront {
 public:
    explicit Wavefront(std::shared_ptr<Device> device) : device_(std::move(device)) {}
    // Traces one sample of these pixels. `go_on` is called between pieces and stops the trace by throwing.
    LaunchTimes trace(cl::CommandQueue& queue, Launcher& launcher, const WavefrontFrame& frame,
                      const std::function<void()>& go_on, const SideWork& side_work = {});
    // Counters of the last sample for each work-group: shadow rays, secondary rays, dropped rays, full stacks, 64 bits each.
    const cl::Buffer& counters() const { return counters_.get(); }
    unsigned counter_count() const { return work_groups_; }

 private:
    // How many rays a level's queue holds, and for how many groups of pixels that is meant.
    struct Room {
        unsigned rays, groups;
        bool splits;  // rays may split
    };
    Room room_for(const WavefrontFrame& frame) const;
    void bind(const WavefrontFrame& frame, const Room& room);
    Launcher::Piece enqueue(cl::CommandQueue& queue, const WavefrontFrame& frame, const Room& room, unsigned first,
                            unsigned count);

    std::shared_ptr<Device> device_;
    std::shared_ptr<const TraceProgram> program_;  // the program of trace_ and add_
    cl::Kernel trace_, add_;
    GrowingBuffer rays_[2] = {GrowingBuffer(CL_MEM_READ_WRITE), GrowingBuffer(CL_MEM_READ_WRITE)};
    GrowingBuffer sums_{CL_MEM_READ_WRITE}, shares_{CL_MEM_READ_WRITE}, counters_{CL_MEM_READ_WRITE};
    cl::Buffer control_[2];  // a picture's first kernel clears the other one for the next picture
    PingPong ping_pong_;     // of control_
    unsigned work_groups_ = 0;
};

}  // namespace clarity
