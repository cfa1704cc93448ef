// kept.hpp -- hits that stay on their device until somebody asks for an array of them.
#pragma once
#include <atomic>
#include <memory>
#include <mutex>

#include "api/clarity.h"
#include "base/aligned_bytes.hpp"
#include "tracers/rays/ray_queries.hpp"

namespace clarity::api {

// A tracer's device, as hits use it that may outlive the tracer.
struct KeepingDevice {
    explicit KeepingDevice(std::shared_ptr<HostCopies> copying) : copies(std::move(copying)) {}
    ~KeepingDevice();
    const std::shared_ptr<HostCopies> copies;
    std::mutex calls;                     // one at a time
    std::atomic<uint64_t> kept_bytes{0};  // of hits on a device that has memory of its own
    // The last buffer that was given back: to make one takes a GPU as long as to trace a million rays.
    cl::Buffer take_spare(size_t bytes);
    void give_spare(cl::Buffer buffer);

 private:
    std::mutex mutex_;
    cl::Buffer spare_;
};

}  // namespace clarity::api

// A tracer fills it while it holds `own`, and then KeepingDevice::calls.
struct clarity_kept {
 public:
    std::mutex own;
    const bool brief;  // only t and prim are wanted
    clarity_kept(std::shared_ptr<clarity::api::KeepingDevice> device, bool only_nearest)
        : brief(only_nearest), device_(std::move(device)) {}
    ~clarity_kept();
    // Room for answers of these rays. Without a buffer in the result there is none on the device, and host() has the arrays.
    // Throws Error(usage) if an array is known to the caller that would have another size.
    const clarity::Answers& begin(size_t count, cl_uint fields);
    clarity::AnswersTo host();
    // The answers are there: reads what the caller has asked for before.
    void end();
    // Waits for calls of the tracer only if there is something to copy.
    void* array(clarity::AnswerArray which);
    bool of(const clarity::api::KeepingDevice& device) const { return device_.get() == &device; }

 private:
    bool is_cpu() const { return device_->copies->device()->info().cpu; }
    // For the numbers of any answer of this kind: a move of instances adds one to each, and arrays that were given out stay.
    void make_room(size_t count);
    void* make(clarity::AnswerArray which);
    void unmap();
    void release();

    const std::shared_ptr<clarity::api::KeepingDevice> device_;
    clarity::Answers answers_;
    size_t room_ = 0;  // bytes of its buffer
    bool found_ = false;
    void *mapped_ = nullptr, *mapped_before_ = nullptr;     // the buffer, on a CPU
    clarity::AlignedBytes memory_[clarity::kAnswerArrays];  // of arrays that are copied
    bool asked_[clarity::kAnswerArrays] = {};
};
