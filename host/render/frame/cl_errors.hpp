// cl_errors.hpp -- an OpenCL failure as a sentence.
#pragma once
#include <CL/opencl.hpp>

#include "base/error.hpp"
#include "device/device.hpp"

namespace clarity {

// Does the work; a cl::Error becomes Error(failed) that says what was being done, and on which device.
template <class Work>
auto wrap_cl_errors(const Device& device, const char* doing, Work&& work) {
    try {
        return work();
    } catch (const cl::Error& e) {
        throw Error(Exit::failed, std::string(doing) + " on " + device.info().name + ": " + e.what() +
                                      " failed with OpenCL error " + std::to_string(e.err()) +
                                      (e.err() == CL_MEM_OBJECT_ALLOCATION_FAILURE ? " (out of memory)" : ""));
    }
}

// From one event's start to the other's end, by the device's clock. NVIDIA's driver does not always know these times at once
// where two queues of a device are in use, nor always at all: then it is `otherwise`.
inline double span_ms(const cl::Event& first, const cl::Event& last, double otherwise = 0) {
    cl_ulong begin = 0, end = 0;
    for (const bool waited : {false, true}) {
        if (clGetEventProfilingInfo(first(), CL_PROFILING_COMMAND_START, sizeof begin, &begin, nullptr) == CL_SUCCESS &&
            clGetEventProfilingInfo(last(), CL_PROFILING_COMMAND_END, sizeof end, &end, nullptr) == CL_SUCCESS)
            return 1e-6 * double(end - begin);
        if (!waited) cl::Event(last).wait();
    }
    return otherwise;
}

// How long the device worked on it.
inline double event_ms(const cl::Event& event, double otherwise = 0) {
    return span_ms(event, event, otherwise);
}

}  // namespace clarity
