// build_kernels.hpp -- the kernels with which structures are built on a device: cl/build, compiled once.
#pragma once
#include <CL/opencl.hpp>
#include <map>
#include <memory>
#include <string>

#include "device/device.hpp"

namespace clarity {

// How the kernels divide their work; the results are the same.
enum class BuildForm {
    automatic,  // serial on a CPU, groups elsewhere
    groups,     // work-groups of 256 work-items
    serial      // one work-item does a group's work in a loop
};

// Compiled kernels of one device. Used from one thread at a time.
class BuildKernels {
 public:
    // Throws Error(kernel_build_failed).
    explicit BuildKernels(std::shared_ptr<Device> device, BuildForm form = BuildForm::automatic);

    Device& device() const { return *device_; }
    bool serial() const { return serial_; }
    unsigned group() const { return serial_ ? 1 : 256; }  // work-items of a work-group: RT_GROUP
    // Whether work-items of a warp talk to each other: RT_WARPS of groups.h.
    bool warps() const { return warps_; }
    unsigned scan_tile() const { return 4096; }

    // Compiles `text` behind groups.h and blocks.h, and with the options of all kernels of builds; the second time it returns
    // the same program. what: for error messages.
    cl::Program compile(const std::string& text, const std::string& what, const std::string& more_options = "") const;
    // The program of one file of cl/build: "scan.cl".
    cl::Program compile_file(const std::string& name, const std::string& more_options = "") const;

    // Enqueues `groups` work-groups on the device's queue.
    cl::Event launch(const cl::Kernel& kernel, size_t groups) const;
    // A buffer of `bytes`, and of 256 at least.
    cl::Buffer buffer(size_t bytes) const;

 private:
    const std::shared_ptr<Device> device_;
    const bool serial_, warps_;
    mutable std::map<std::string, cl::Program> programs_;  // by options and text
};

}  // namespace clarity
