// wavefront.hpp -- the host's side of cl/tracers/wavefront.cl: queues on the device, and which kernel follows which.
#pragma once
#include <memory>

#include "render/film/growing_buffer.hpp"
#include "render/frame/launch.hpp"
#include "render/frame/renderer.hpp"
#include "render/frame/view_buffers.hpp"
#include "render/kernels/kernel_source.hpp"
#include "render/queries/ping_pong.hpp"

namespace clarity {

// One picture's, or of work-groups [begin, begin + groups) of it. The buffers are the caller's; film and distances are as
// trace_iterative has them.
struct WavefrontFrame {
    const Prepared& prepared;
    const View& view;
    const ViewBuffers& view_buffers;
    Layout layout;
    unsigned width, height, begin, groups, depth, sample;
    const cl::Buffer &film, &distances;
};

// Whether a ray may part in two: any of a view's materials, or of the scene's where the view has none, is transparent.
bool refracts(const Scene& scene, const std::vector<rt_material>& materials);

class Wavefront {
 public:
    explicit Wavefront(std::shared_ptr<Device> device) : device_(std::move(device)) {}
    // A sample of these pixels. go_on is asked between pieces and stops by throwing.
    LaunchTimes trace(cl::CommandQueue& queue, Launcher& launcher, const WavefrontFrame& frame,
                      const std::function<void()>& go_on, const Beside& beside = {});
    // Of the last sample: shadow, secondary, dropped rays and full stacks of each work-group, 64 bits each.
    const cl::Buffer& counters() const { return counters_.get(); }
    unsigned counter_count() const { return work_groups_; }

 private:
    // How many rays may be put aside at each level, and for how many groups of pixels that is meant.
    struct Room {
        unsigned rays, groups;
        bool parting;  // rays may part at all
    };
    Room room_for(const WavefrontFrame& frame) const;
    void bind(const WavefrontFrame& frame, const Room& room);
    Launcher::Piece enqueue(cl::CommandQueue& queue, const WavefrontFrame& frame, const Room& room, unsigned first,
                            unsigned count);

    std::shared_ptr<Device> device_;
    std::shared_ptr<const TraceProgram> program_;  // whose kernels these are
    cl::Kernel trace_, add_;
    GrowingBuffer rays_[2] = {GrowingBuffer(CL_MEM_READ_WRITE), GrowingBuffer(CL_MEM_READ_WRITE)};
    GrowingBuffer sums_{CL_MEM_READ_WRITE}, shares_{CL_MEM_READ_WRITE}, counters_{CL_MEM_READ_WRITE};
    cl::Buffer control_[2];  // a picture's first kernel clears the other one
    PingPong turns_;         // of control_
    unsigned work_groups_ = 0;
};

}  // namespace clarity
