// device.hpp -- OpenCL devices: listing, ranking and choosing them, and one open device with its queue.
#pragma once
#include <CL/opencl.hpp>
#include <memory>
#include <string>
#include <vector>

#include "device/device_loss.hpp"
#include "device/queue.hpp"

namespace clarity {

// A device that may be opened, or one part of it.
struct DeviceInfo {
    unsigned platform_index = 0, device_index = 0;  // as `clinfo -l` counts them
    unsigned part = 0,
             parts = 0;  // of a CPU that is split: index of this part, and number of parts; parts = 0: the whole device
    std::string platform, name, vendor, version, driver;
    bool cpu = false, gpu = false;
    unsigned compute_units = 0, clock_mhz = 0, float_width = 1;  // float_width: native_vector_width_float
    uint64_t global_bytes = 0, max_allocation_bytes = 0;
    uint64_t cache_bytes = 0, local_bytes = 0;  // cache that all units share, local memory of a work-group; 0: not known
    unsigned cache_line_bytes = 0;
    bool pocl = false, nvidia = false;
    bool llvmpipe = false;  // Mesa's driver for CPUs, which computes work-items side by side, as a GPU does
    cl::Platform cl_platform;
    cl::Device cl_device;
    std::string id() const;  // "0:0"; the second of four parts: "0:0/4.1"
    // Of a part, which has the name of the device and its own number, the first alone. Parts run the programs of the whole.
    std::string name_of_whole() const;
    // Whether a work-item traces a packet of rays in lanes, and not one ray. Layouts and kernels follow this.
    bool traces_packets() const { return cpu && !llvmpipe; }
    // Lanes that suit the device: 1, or the native float width if it traces packets.
    unsigned preferred_lanes() const;
};

// What is wrong with a platform, or with one of its devices.
struct DeviceWarning {
    std::string text;
    // A driver without a device, as Mesa's on a machine without a GPU of its kind, where another driver has one: for the list.
    bool is_minor = false;
};

// Returns all devices of all platforms, best first: GPUs, then CPUs, then others, each ordered by compute units x clock. A
// platform is skipped if it has no devices or if its driver fails; `warnings` gets a line about it.
std::vector<DeviceInfo> list_devices(std::vector<DeviceWarning>* warnings = nullptr);
// Logs them; minor ones for -v alone.
void log_warnings(const std::vector<DeviceWarning>& warnings);

// Returns the devices that `choice` names, each once. "": CLARITY_DEVICE, or else the best device. Otherwise words with commas
// between them:
//   2, P:D, cpu, gpu, part of a name   one device: by its place in the list, by its id, the first CPU or GPU, the first match
//   cpus, gpus, all                    every such device
//   WORD/4, WORD/4.1                   four parts of the device (sub-devices), or the second of these
// Throws Error(no_device), which lists the devices.
std::vector<DeviceInfo> choose_devices(const std::string& choice);
// Returns the first of choose_devices().
DeviceInfo choose_device(const std::string& choice);
// Returns the ids with commas between them, as choose_devices() reads them.
std::string device_list_text(const std::vector<DeviceInfo>& devices);

// An open device. Use each object from one thread at a time; only programs may be built from other threads.
class Device {
 public:
    // Throws Error(no_device).
    explicit Device(DeviceInfo info);
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    const DeviceInfo& info() const { return info_; }
    cl::Context& context() { return context_; }
    Queue& queue() { return queue_; }  // in order, profiling enabled
    // Shared by all queues of the context. A device that is lost has to be opened anew.
    const std::shared_ptr<DeviceLoss>& loss() const { return loss_; }
    // Waits for what is in the queue, on a CPU: after a failure the owner of a buffer frees it, and kernels of PoCL do not keep
    // theirs. Drivers for GPUs do.
    void drain() const noexcept;
    // Returns the same device and context with a queue of its own, so that kernels of both queues may run at the same time.
    std::shared_ptr<Device> with_own_queue() const;

 private:
    Device(DeviceInfo info, cl::Context context, std::shared_ptr<DeviceLoss> loss);
    DeviceInfo info_;
    std::shared_ptr<DeviceLoss> loss_;
    cl::Context context_;
    Queue queue_;
};

}  // namespace clarity
