// dynamic_fetch.hpp -- nearest hits of the caller's own rays. Persistent work-items fetch a new ray whenever they are free
// (cl/tracers/rays/dynamic_fetch.cl; Aila, Laine 2009, Understanding the Efficiency of Ray Traversal on GPUs).
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
class DynamicFetch {
 public:
    explicit DynamicFetch(std::shared_ptr<Device> device) : device_(std::move(device)) {}
    // Traces `rays` rays of `in` and writes their answers, `fields` numbers a ray (RT_ANSWER_*), to `out`.
    // program: of the kernel dynamic_fetch(). overflows: already cleared if it is a debug program. Throws cl::Error.
    LaunchTimes trace(const Prepared& prepared, const TraceProgram& program, const ViewBuffers& view, unsigned rays,
                      cl_uint fields, const cl::Buffer& in, const cl::Buffer& out, OverflowCounter& overflows);
    // Call this when the program, the scene or the rays change: the pace is then no longer known.
    void forget() { launcher_.forget(); }

 private:
    std::shared_ptr<Device> device_;
    Launcher launcher_;
    GrowingBuffer queue_{CL_MEM_READ_WRITE};
    PingPong ping_pong_;
};

}  // namespace clarity
