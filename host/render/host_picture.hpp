// host_picture.hpp -- memory of the host that a device writes to without a detour.
#pragma once
#include <CL/opencl.hpp>
#include <vector>

#include "device/device.hpp"

namespace clarity {

// A GPU copies into pinned memory at 55 GB/s over PCIe 5, into any other at 10 to 20: the driver then copies once more. On a
// CPU the device's memory is the host's already, and is looked at where it is.
class HostPicture {
 public:
    explicit HostPicture(std::shared_ptr<Device> device) : device_(std::move(device)) {}
    ~HostPicture() { release(); }
    HostPicture(const HostPicture&) = delete;
    HostPicture& operator=(const HostPicture&) = delete;

    // Gives back what was taken of `source` before; then it may be written to, or go.
    void release();
    // The first `bytes` of a buffer, when all that is queued is done; stays until the next release(), fetch() or begin().
    // `done` is the copy's event, or none.
    const uint8_t* fetch(const cl::Buffer& source, size_t bytes, cl::Event* done);
    // The same without waiting: what is returned is there once `done` is. Not for a CPU. after: waited for first, by the
    // device.
    const uint8_t* begin(const cl::Buffer& source, size_t bytes, cl::Event* done, const std::vector<cl::Event>& after = {});
    // So many bytes of pinned memory, which stay where they are until more are wanted. Not for a CPU.
    uint8_t* pinned(size_t bytes);

 private:
    std::shared_ptr<Device> device_;
    cl::Buffer mapped_;  // what memory_ belongs to
    void* memory_ = nullptr;
    size_t room_ = 0;  // of pinned memory
};

}  // namespace clarity
