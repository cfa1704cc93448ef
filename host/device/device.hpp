// device.hpp -- OpenCL devices: listing, ranking, choosing, and one open device with its queue.
#pragma once
#include <CL/opencl.hpp>
#include <atomic>
#include <memory>
#include <string>
#include <vector>

namespace clarity {

struct DeviceInfo {
    unsigned platform_index = 0, device_index = 0;  // as clinfo -l counts them
    std::string platform, name, vendor, version, driver;
    bool cpu = false, gpu = false;
    unsigned compute_units = 0, clock_mhz = 0, float_width = 1;  // native_vector_width_float
    uint64_t global_bytes = 0, max_allocation_bytes = 0;
    bool pocl = false, nvidia = false;
    cl::Platform cl_platform;
    cl::Device cl_device;
    std::string id() const { return std::to_string(platform_index) + ":" + std::to_string(device_index); }
};

// All devices of all platforms, best first (GPU before CPU before others, then compute units x clock). A platform without
// devices or with a failing driver is skipped with a warning in `warnings`.
std::vector<DeviceInfo> list_devices(std::vector<std::string>* warnings = nullptr);

// choice: "" (CLARITY_DEVICE, else the best), "P:D", "cpu", "gpu", or part of a name. Throws Error(no_device) that lists what
// there is.
DeviceInfo choose_device(const std::string& choice);

// An open device. Not thread-safe per object, except that programs may be built from other threads.
class Device {
 public:
    explicit Device(DeviceInfo info);
    const DeviceInfo& info() const { return info_; }
    cl::Context& context() { return context_; }
    cl::CommandQueue& queue() { return queue_; }  // in order, profiling enabled
    // Gives context and queue back; nothing may use them afterwards. info() stays.
    void close();
    bool is_open() const { return open_; }
    // Lanes that suit it: 1 on a GPU, the native float width on a CPU.
    unsigned preferred_lanes() const;

 private:
    DeviceInfo info_;
    cl::Context context_;
    cl::CommandQueue queue_;
    std::atomic<bool> open_{true};
};

}  // namespace clarity
