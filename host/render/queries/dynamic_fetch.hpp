// dynamic_fetch.hpp -- nearest hits of the caller's own rays, which work-items draw as they get free
// (cl/queries/dynamic_fetch.cl).
#pragma once
#include "render/film/overflow_counter.hpp"
#include "render/frame/launch.hpp"
#include "render/frame/renderer.hpp"
#include "render/frame/view_buffers.hpp"
#include "render/kernels/program_cache.hpp"
#include "render/queries/ping_pong.hpp"

namespace clarity {

class DynamicFetch {
 public:
    explicit DynamicFetch(std::shared_ptr<Device> device) : device_(std::move(device)) {}
    // program: of kind queued_rays. overflows: cleared, if it is a debug program.
    LaunchTimes trace(const Prepared& prepared, const TraceProgram& program, const ViewBuffers& view, unsigned rays,
                      cl_uint fields, const cl::Buffer& in, const cl::Buffer& out, OverflowCounter& overflows);
    void forget() { launcher_.forget(); }

 private:
    std::shared_ptr<Device> device_;
    Launcher launcher_;
    GrowingBuffer queue_{CL_MEM_READ_WRITE};
    PingPong turns_;
};

}  // namespace clarity
