#include "support/faults.hpp"

#include <CL/cl.h>
#include <dlfcn.h>

#include <chrono>
#include <thread>
#include <vector>

namespace clarity::test {

Faults faults;

void Faults::end() {
    largest_buffer = ~size_t(0);
    launches_left = copies_left = -1;
    copy_ms = 0;
}

namespace {

template <class Function>
Function* driver(const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

bool refused(std::atomic<int>& left) {
    if (left == 0) return true;
    if (left > 0) --left;
    return false;
}

// Returns an event that completes after `ms`.
cl_event later(cl_command_queue queue, unsigned ms) {
    cl_context context = nullptr;
    clGetCommandQueueInfo(queue, CL_QUEUE_CONTEXT, sizeof context, &context, nullptr);
    cl_event event = clCreateUserEvent(context, nullptr);
    clRetainEvent(event);
    std::thread([event, ms] {
        std::this_thread::sleep_for(std::chrono::milliseconds(ms));
        clSetUserEventStatus(event, CL_COMPLETE);
        clReleaseEvent(event);
    }).detach();
    return event;
}

}  // namespace
}  // namespace clarity::test

using namespace clarity::test;

extern "C" cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* error) {
    static const auto real = driver<decltype(clCreateBuffer)>("clCreateBuffer");
    if (size <= faults.largest_buffer) return real(context, flags, size, host, error);
    if (error) *error = CL_MEM_OBJECT_ALLOCATION_FAILURE;
    return nullptr;
}

extern "C" cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t* offset,
                                         const size_t* global, const size_t* local, cl_uint count, const cl_event* after,
                                         cl_event* event) {
    static const auto real = driver<decltype(clEnqueueNDRangeKernel)>("clEnqueueNDRangeKernel");
    if (refused(faults.launches_left)) return CL_OUT_OF_RESOURCES;
    return real(queue, kernel, dimensions, offset, global, local, count, after, event);
}

extern "C" cl_int clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer, cl_bool wait, size_t offset, size_t bytes,
                                      void* to, cl_uint count, const cl_event* after, cl_event* event) {
    static const auto real = driver<decltype(clEnqueueReadBuffer)>("clEnqueueReadBuffer");
    if (refused(faults.copies_left)) return CL_OUT_OF_RESOURCES;
    if (wait || faults.copy_ms == 0) return real(queue, buffer, wait, offset, bytes, to, count, after, event);
    std::vector<cl_event> all(after, after + count);
    all.push_back(later(queue, faults.copy_ms));
    const cl_int result = real(queue, buffer, wait, offset, bytes, to, cl_uint(all.size()), all.data(), event);
    clReleaseEvent(all.back());
    return result;
}
