// launch_limit.hpp -- waits for a device, but not for ever.
//
// A kernel that loops for ever ends on no GPU without a display, and no call of OpenCL stops it. So the thread that waits asks
// for the state of an event, and gives up after a limit. The device is then stuck (device_loss.hpp): its objects are kept, and
// the caller may open it anew, in another context. A CPU is waited for without a limit: its threads would be busy for ever, in
// any context. Kernels for CPUs are therefore tried in a worker first (trial/trial.hpp).
#pragma once
#include <CL/opencl.hpp>
#include <functional>
#include <string>

#include "device/device.hpp"

namespace clarity {

// Seconds that a launch may take on a GPU, by the host's clock: CLARITY_LAUNCH_LIMIT, else 20. Infinite if that is 0. Launches
// are cut into pieces of 0.2 s (Pace in launch/launch.hpp).
double launch_limit_s();

// Waits for an event of the device. Throws Error(failed) after the limit, and cl::Error if the work failed. what: the work, for
// the message: "the kernel trace_iterative".
void wait_for(const Device& device, const cl::Event& event, const std::function<std::string()>& what);
void wait_for(const Device& device, const cl::Event& event, const char* what);
// Waits for everything in the queue, likewise.
void finish(const Device& device, Queue& queue, const char* what);

}  // namespace clarity
