// cl_errors.hpp -- turns OpenCL errors into messages, and events into times.
#pragma once
#include <CL/opencl.hpp>

#include "base/error.hpp"
#include "device/device.hpp"

namespace clarity {

// Whether a call fails with this error after the device itself has failed. -9999: NVIDIA's, after a read out of bounds.
inline bool means_lost(cl_int error) {
    constexpr cl_int kNvidiaIllegalAccess = -9999;
    return error == CL_DEVICE_NOT_AVAILABLE || error == CL_INVALID_CONTEXT || error == CL_INVALID_COMMAND_QUEUE ||
           error == CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST || error == kNvidiaIllegalAccess;
}

// The message of a failed call. Notes it if the device is lost, and waits for what a CPU still does.
inline Error error_on(const Device& device, const std::string& doing, const cl::Error& e) {
    device.drain();
    if (means_lost(e.err())) device.loss()->note_failed();
    if (e.err() == CL_OUT_OF_RESOURCES) device.loss()->note_refused();
    const bool lost = device.loss()->lost();
    return Error(Exit::failed, doing + " on " + device.info().name + ": " + e.what() + " failed with OpenCL error " +
                                   std::to_string(e.err()) +
                                   (e.err() == CL_MEM_OBJECT_ALLOCATION_FAILURE ? " (out of memory)" : "") +
                                   (lost ? ", after which the device cannot be used until it is opened anew" : ""));
}

// Calls `work` and returns its result. A cl::Error becomes Error(failed), which names the action (`doing`), the device, the
// failed OpenCL function and its code.
template <class Work>
auto wrap_cl_errors(const Device& device, const char* doing, Work&& work) {
    try {
        return work();
    } catch (const cl::Error& e) {
        throw error_on(device, doing, e);
    }
}

// Time in ms from the start of `first` to the end of `last`, by the device's clock. NVIDIA's driver does not always know these
// times at once if two queues of a device are in use, and sometimes never: the result is then `otherwise`.
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

// Time in ms that the device spent on one event.
inline double event_ms(const cl::Event& event, double otherwise = 0) {
    return span_ms(event, event, otherwise);
}

}  // namespace clarity
