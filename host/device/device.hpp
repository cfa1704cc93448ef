// device.hpp -- OpenCL devices: listing, ranking, choosing, and one open device with its queue.
#pragma once
#include <CL/opencl.hpp>
#include <memory>
#include <string>
#include <vector>

namespace clarity {

struct DeviceInfo {
    unsigned platform_index = 0, device_index = 0;  // as clinfo -l counts them
    unsigned part = 0, parts = 0;                   // of a CPU that is parted, counted from 0; 0 parts: it is whole
    std::string platform, name, vendor, version, driver;
    bool cpu = false, gpu = false;
    unsigned compute_units = 0, clock_mhz = 0, float_width = 1;  // native_vector_width_float
    uint64_t global_bytes = 0, max_allocation_bytes = 0;
    bool pocl = false, nvidia = false;
    cl::Platform cl_platform;
    cl::Device cl_device;
    std::string id() const;  // "0:0"; the second of four parts: "0:0/4.1"
};

// All devices of all platforms, best first (GPU before CPU before others, then compute units x clock). A platform without
// devices or with a failing driver is skipped with a warning in `warnings`.
std::vector<DeviceInfo> list_devices(std::vector<std::string>* warnings = nullptr);

// choice: "" (CLARITY_DEVICE, else the best), or words with commas between them, each device once:
//   2, P:D, cpu, gpu, part of a name   one: by its place in the list, by its id, the first that fits
//   cpus, gpus, all                    every one
//   WORD/4, WORD/4.1                   in four parts (sub-devices), or the second of these
// Throws Error(no_device) that lists what there is.
std::vector<DeviceInfo> choose_devices(const std::string& choice);
// The first of them.
DeviceInfo choose_device(const std::string& choice);
// As choose_devices() reads it: ids with commas.
std::string device_list_text(const std::vector<DeviceInfo>& devices);

// An open device. Not thread-safe per object, except that programs may be built from other threads.
class Device {
 public:
    explicit Device(DeviceInfo info);
    const DeviceInfo& info() const { return info_; }
    cl::Context& context() { return context_; }
    cl::CommandQueue& queue() { return queue_; }  // in order, profiling enabled
    // The same device and context with a queue of its own, so that kernels of both may run side by side.
    std::shared_ptr<Device> with_own_queue() const;
    // Lanes that suit it: 1 on a GPU, the native float width on a CPU.
    unsigned preferred_lanes() const;

 private:
    Device(DeviceInfo info, cl::Context context);
    DeviceInfo info_;
    cl::Context context_;
    cl::CommandQueue queue_;
};

}  // namespace clarity
