#include "api/kept.hpp"

#include <algorithm>
#include <iterator>

#include "base/error.hpp"
#include "device/cl_errors.hpp"
#include "device/device_loss.hpp"
#include "device/growing_buffer.hpp"

namespace clarity::api {
namespace {

// Hits on a device take at most this share of its memory; more of them are read at once.
constexpr uint64_t kShare = 4;

}  // namespace

KeepingDevice::~KeepingDevice() {
    if (copies->device()->loss()->stuck()) never_release(std::make_shared<cl::Buffer>(spare_));
}

cl::Buffer KeepingDevice::take_spare(size_t bytes) {
    const std::lock_guard<std::mutex> lock(mutex_);
    cl::Buffer spare;
    if (spare_() && spare_.getInfo<CL_MEM_SIZE>() >= bytes && spare_.getInfo<CL_MEM_SIZE>() / 2 <= bytes)
        std::swap(spare, spare_);
    return spare;
}

void KeepingDevice::give_spare(cl::Buffer buffer) {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::swap(spare_, buffer);
}

}  // namespace clarity::api

using namespace clarity;
using namespace clarity::api;

clarity_kept::~clarity_kept() {
    try {
        release();
    } catch (const cl::Error&) {  // the device is lost, and this memory with it
    }
}

const Answers& clarity_kept::begin(size_t count, cl_uint fields) {
    const bool asked = std::find(std::begin(asked_), std::end(asked_), true) != std::end(asked_);
    if (asked && count != answers_.count)
        throw Error(Exit::usage, "the kept hits are " + std::to_string(answers_.count) +
                                     ", of which arrays are in use, and these are " + std::to_string(count) +
                                     ": keep them apart");
    found_ = false;
    const Device& device = *device_->copies->device();
    wrap_cl_errors(device, "making room for hits", [&] {
        unmap();
        if (count != answers_.count || !answers_.buffer()) make_room(count);
        return 0;
    });
    answers_.fields = fields;
    return answers_;
}

void clarity_kept::make_room(size_t count) {
    if (count != answers_.count)
        for (AlignedBytes& of_array : memory_) of_array = {};
    release();
    answers_ = {{}, count, answer_stride(count), 0, brief ? RT_ANSWER_NEAREST : RT_ANSWER_PLACED};
    const uint64_t bytes = room_ = answers_.bytes();
    Device& device = *device_->copies->device();
    if (bytes == 0 || bytes > device.info().max_allocation_bytes) return;
    if (!is_cpu()) {
        if (device_->kept_bytes + bytes > device.info().global_bytes / kShare) return;
        answers_.buffer = device_->take_spare(bytes);
    }
    for (size_t k = 0; k < kAnswerArrays; ++k)
        if (!asked_[k]) memory_[k] = {};  // of hits that were not on the device
    if (!answers_.buffer()) answers_.buffer = GrowingBuffer(CL_MEM_READ_WRITE).fit(device.context(), bytes);
    if (!is_cpu()) device_->kept_bytes += bytes;
}

AnswersTo clarity_kept::host() {
    AnswersTo to;
    for (size_t k = 0; k < kAnswerArrays; ++k)
        if (first_field(AnswerArray(k)) < answers_.fields || asked_[k]) to.arrays[k] = make(AnswerArray(k));
    return to;
}

void clarity_kept::end() {
    wrap_cl_errors(*device_->copies->device(), "reading hits", [&] {
        if (!answers_.buffer()) return 0;
        AnswersTo again;
        for (size_t k = 0; k < kAnswerArrays; ++k)
            if (first_field(AnswerArray(k)) < answers_.fields) again.arrays[k] = memory_[k].data();
        read_answers(*device_->copies, answers_, again);
        if (!is_cpu()) return 0;
        mapped_ =
            device_->copies->device()->queue().enqueueMapBuffer(answers_.buffer, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, room_);
        if (mapped_before_ && mapped_ != mapped_before_)
            throw Error(Exit::failed, "the device's driver has moved arrays of hits that are in use; take new ones");
        mapped_before_ = mapped_;
        return 0;
    });
    found_ = true;
}

void* clarity_kept::array(AnswerArray which) {
    const auto k = static_cast<size_t>(which);
    const std::lock_guard<std::mutex> lock(own);
    if (!found_)
        throw Error(Exit::usage,
                    "there are no hits: the call that had to find them failed or was cancelled; trace the rays again");
    asked_[k] = true;
    const bool on_device = answers_.buffer() && first_field(which) < answers_.fields;
    if (memory_[k].data()) return memory_[k].data();  // it was given out, and end() has filled it
    if (mapped_ && on_device) return static_cast<float*>(mapped_) + first_field(which) * answers_.stride;
    AnswersTo to;
    to.arrays[k] = make(which);
    Answers from = answers_;
    if (!on_device) from.fields = 0;  // the array is all nothing
    try {
        const std::lock_guard<std::mutex> calls(device_->calls);
        wrap_cl_errors(*device_->copies->device(), "reading hits", [&] {
            read_answers(*device_->copies, from, to);
            return 0;
        });
    } catch (const Error&) {
        memory_[k] = {};
        throw;
    }
    return to.arrays[k];
}

void* clarity_kept::make(AnswerArray which) {
    AlignedBytes& memory = memory_[static_cast<size_t>(which)];
    const size_t bytes = std::max<size_t>(answers_.count * width_of(which) * sizeof(float), 1);
    if (!memory.data()) memory = AlignedBytes(bytes, false);
    return memory.data();
}

void clarity_kept::unmap() {
    if (mapped_) device_->copies->device()->queue().enqueueUnmapMemObject(answers_.buffer, mapped_);
    mapped_ = nullptr;
}

void clarity_kept::release() {
    const bool stuck = device_->copies->device()->loss()->stuck();
    if (answers_.buffer() && !is_cpu()) {
        device_->kept_bytes -= room_;
        if (stuck)
            never_release(std::make_shared<cl::Buffer>(answers_.buffer));
        else
            device_->give_spare(answers_.buffer);
    }
    if (!stuck) unmap();
    answers_ = {};
    mapped_before_ = nullptr;
}
