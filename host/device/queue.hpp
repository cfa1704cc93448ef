// queue.hpp -- a command queue. While a timeline is recorded, each command that moves or computes something is a span of it.
#pragma once
#include <CL/opencl.hpp>
#include <string>

#include "base/timeline.hpp"

namespace clarity {

// A queue in order. As cl::CommandQueue, with commands that are seen. An event is asked for each command only where a timeline
// is recorded. Use it from one thread at a time.
class Queue : public cl::CommandQueue {
 public:
    Queue() = default;
    // times: whether events of its commands are asked for their times; always, while a timeline is recorded.
    Queue(const cl::Context& context, const cl::Device& device, bool times = false)
        : cl::CommandQueue(context, device, times || timeline::recording() ? CL_QUEUE_PROFILING_ENABLE : 0) {}

    using Events = std::vector<cl::Event>;
    cl_int enqueueNDRangeKernel(const cl::Kernel& kernel, const cl::NDRange& offset, const cl::NDRange& global,
                                const cl::NDRange& local = cl::NullRange, const Events* after = nullptr,
                                cl::Event* done = nullptr) const {
        return seen(
            "launch", [&] { return kernel.getInfo<CL_KERNEL_FUNCTION_NAME>(); }, 0, done,
            [&](cl::Event* event) { return Base::enqueueNDRangeKernel(kernel, offset, global, local, after, event); });
    }
    cl_int enqueueReadBuffer(const cl::Buffer& from, cl_bool wait, size_t at, size_t bytes, void* to,
                             const Events* after = nullptr, cl::Event* done = nullptr) const {
        return seen("copy", "read", bytes, done,
                    [&](cl::Event* event) { return Base::enqueueReadBuffer(from, wait, at, bytes, to, after, event); });
    }
    cl_int enqueueWriteBuffer(const cl::Buffer& to, cl_bool wait, size_t at, size_t bytes, const void* from,
                              const Events* after = nullptr, cl::Event* done = nullptr) const {
        return seen("copy", "write", bytes, done,
                    [&](cl::Event* event) { return Base::enqueueWriteBuffer(to, wait, at, bytes, from, after, event); });
    }
    cl_int enqueueReadBufferRect(const cl::Buffer& from, cl_bool wait, const cl::array<size_t, 3>& buffer_at,
                                 const cl::array<size_t, 3>& host_at, const cl::array<size_t, 3>& region, size_t buffer_row,
                                 size_t buffer_slice, size_t host_row, size_t host_slice, void* to,
                                 const Events* after = nullptr, cl::Event* done = nullptr) const {
        return seen("copy", "read", region[0] * region[1] * region[2], done, [&](cl::Event* event) {
            return Base::enqueueReadBufferRect(from, wait, buffer_at, host_at, region, buffer_row, buffer_slice, host_row,
                                               host_slice, to, after, event);
        });
    }
    cl_int enqueueCopyBuffer(const cl::Buffer& from, const cl::Buffer& to, size_t from_at, size_t to_at, size_t bytes,
                             const Events* after = nullptr, cl::Event* done = nullptr) const {
        return seen("copy", "on the device", bytes, done,
                    [&](cl::Event* event) { return Base::enqueueCopyBuffer(from, to, from_at, to_at, bytes, after, event); });
    }
    template <class Pattern>
    cl_int enqueueFillBuffer(const cl::Buffer& buffer, Pattern pattern, size_t at, size_t bytes, const Events* after = nullptr,
                             cl::Event* done = nullptr) const {
        return seen("copy", "fill", bytes, done,
                    [&](cl::Event* event) { return Base::enqueueFillBuffer(buffer, pattern, at, bytes, after, event); });
    }
    void* enqueueMapBuffer(const cl::Buffer& buffer, cl_bool wait, cl_map_flags flags, size_t at, size_t bytes,
                           const Events* after = nullptr, cl::Event* done = nullptr, cl_int* error = nullptr) const {
        void* mapped = nullptr;
        seen("copy", "map", bytes, done, [&](cl::Event* event) {
            mapped = Base::enqueueMapBuffer(buffer, wait, flags, at, bytes, after, event, error);
            return CL_SUCCESS;
        });
        return mapped;
    }

 private:
    using Base = cl::CommandQueue;
    // name: as of timeline::Scope.
    template <class Name, class Enqueue>
    cl_int seen(const char* kind, const Name& name, uint64_t bytes, cl::Event* done, Enqueue enqueue) const {
        if (!timeline::recording()) return enqueue(done);
        cl::Event event;
        const cl_int result = enqueue(&event);
        if (event()) note({timeline::text_of(name), kind, 0, 0, bytes}, event);
        if (done) *done = event;
        return result;
    }
    void note(timeline::Span span, const cl::Event& event) const;
};

}  // namespace clarity
