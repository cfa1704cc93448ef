// long_rays.hpp -- rays of the caller's own in two launches: those that take long in one of their own
// (cl/tracers/long_rays.cl).
#pragma once
#include <algorithm>

#include "render/launch.hpp"
#include "render/renderer.hpp"
#include "render/trace_program.hpp"
#include "render/view_buffers.hpp"

namespace clarity {

// The faster of two ways to do the same thing, found out by doing it: in turns, each four times, of which the least time
// counts; but not the first, which may be cut into small pieces and hold a compilation.
class FasterWay {
 public:
    bool takes_second() const { return tried_ < kTries ? tried_ % 2 == 1 : ms_[1] < kWorthIt * ms_[0]; }
    void took(double ms) {
        if (tried_ >= kTries) return;
        double& least = ms_[tried_ % 2];
        if (tried_++ >= 2) least = std::min(least, ms);
    }

 private:
    static constexpr unsigned kTries = 8;
    static constexpr double kWorthIt = 0.97;  // of the first's time: less is noise
    unsigned tried_ = 0;
    double ms_[2] = {1e30, 1e30};
};

class LongRays {
 public:
    explicit LongRays(std::shared_ptr<Device> device) : device_(std::move(device)) {}
    // program: of kind long_rays.
    LaunchTimes trace(const Prepared& prepared, const TraceProgram& program, const ViewBuffers& view, unsigned rays,
                      bool any_hit, cl_uint fields, const cl::Buffer& in, const cl::Buffer& out);
    void forget() { launcher_.forget(); }

 private:
    std::shared_ptr<Device> device_;
    Launcher launcher_;
    GrowingBuffer list_{CL_MEM_READ_WRITE};
    cl_uint turn_ = 0;
    bool clean_ = false;  // the list is, for this turn
};

}  // namespace clarity
