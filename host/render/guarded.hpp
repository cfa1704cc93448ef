// guarded.hpp -- an OpenCL failure as a sentence.
#pragma once
#include <CL/opencl.hpp>

#include "base/error.hpp"
#include "device/device.hpp"

namespace clarity {

// Does the work; a cl::Error becomes Error(failed) that says what was being done, and on which device.
template <class Work>
auto guarded(const Device& device, const char* doing, Work&& work) {
    try {
        return work();
    } catch (const cl::Error& e) {
        throw Error(Exit::failed, std::string(doing) + " on " + device.info().name + ": " + e.what() +
                                      " failed with OpenCL error " + std::to_string(e.err()) +
                                      (e.err() == CL_MEM_OBJECT_ALLOCATION_FAILURE ? " (out of memory)" : ""));
    }
}

// How long the device worked on it.
inline double event_ms(const cl::Event& event) {
    return 1e-6 *
           double(event.getProfilingInfo<CL_PROFILING_COMMAND_END>() - event.getProfilingInfo<CL_PROFILING_COMMAND_START>());
}

}  // namespace clarity
