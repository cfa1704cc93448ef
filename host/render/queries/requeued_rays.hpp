// requeued_rays.hpp -- rays of the caller's own in two launches: those that take long in one of their own
// (cl/queries/requeued_rays.cl).
#pragma once
#include "render/film/overflow_counter.hpp"
#include "render/frame/launch.hpp"
#include "render/frame/renderer.hpp"
#include "render/frame/view_buffers.hpp"
#include "render/kernels/program_cache.hpp"
#include "render/queries/ping_pong.hpp"

namespace clarity {

class RequeuedRays {
 public:
    explicit RequeuedRays(std::shared_ptr<Device> device) : device_(std::move(device)) {}
    // program: of kind long_rays. overflows: cleared, if it is a debug program.
    LaunchTimes trace(const Prepared& prepared, const TraceProgram& program, const ViewBuffers& view, unsigned rays,
                      bool any_hit, cl_uint fields, const cl::Buffer& in, const cl::Buffer& out, OverflowCounter& overflows);
    void forget() { launcher_.forget(); }

 private:
    std::shared_ptr<Device> device_;
    Launcher launcher_;
    GrowingBuffer list_{CL_MEM_READ_WRITE};
    PingPong turns_;
};

}  // namespace clarity
