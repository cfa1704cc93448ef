// long_rays.hpp -- rays of the caller's own in two launches: those that take long in one of their own
// (cl/tracers/long_rays.cl).
#pragma once
#include "render/launch.hpp"
#include "render/overflow_counter.hpp"
#include "render/renderer.hpp"
#include "render/trace_program.hpp"
#include "render/turns.hpp"
#include "render/view_buffers.hpp"

namespace clarity {

class LongRays {
 public:
    explicit LongRays(std::shared_ptr<Device> device) : device_(std::move(device)) {}
    // program: of kind long_rays. overflows: cleared, if it is a debug program.
    LaunchTimes trace(const Prepared& prepared, const TraceProgram& program, const ViewBuffers& view, unsigned rays,
                      bool any_hit, cl_uint fields, const cl::Buffer& in, const cl::Buffer& out, OverflowCounter& overflows);
    void forget() { launcher_.forget(); }

 private:
    std::shared_ptr<Device> device_;
    Launcher launcher_;
    GrowingBuffer list_{CL_MEM_READ_WRITE};
    Turns turns_;
};

}  // namespace clarity
