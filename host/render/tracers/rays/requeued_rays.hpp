// requeued_rays.hpp -- traces the caller's own rays in two launches. The first stops rays that exceed a step budget
// and lists them. The second traces each of these with several work-items side by side (cl/tracers/rays/requeued_rays.cl).
#pragma once
#include "device/device.hpp"
#include "render/film/overflow_counter.hpp"
#include "render/kernels/program_cache.hpp"
#include "render/launch/launch.hpp"
#include "render/launch/ping_pong.hpp"
#include "render/launch/prepared.hpp"
#include "render/launch/view_buffers.hpp"

namespace clarity {

// The host's side of these kernels. Used from one thread.
class RequeuedRays {
 public:
    explicit RequeuedRays(std::shared_ptr<Device> device) : device_(std::move(device)) {}
    // Traces `rays` rays of `in` and writes their answers, `fields` numbers a ray (RT_ANSWER_*), to `out`.
    // program: of the kernel requeued_rays(). overflows: already cleared if it is a debug program. Throws cl::Error.
    LaunchTimes trace(const Prepared& prepared, const TraceProgram& program, const ViewBuffers& view, unsigned rays,
                      bool any_hit, cl_uint fields, const cl::Buffer& in, const cl::Buffer& out, OverflowCounter& overflows);
    // Call this when the program, the scene or the rays change: the pace is then no longer known.
    void forget() { launcher_.forget(); }

 private:
    std::shared_ptr<Device> device_;
    Launcher launcher_;
    GrowingBuffer list_{CL_MEM_READ_WRITE};
    PingPong ping_pong_;
};

}  // namespace clarity
