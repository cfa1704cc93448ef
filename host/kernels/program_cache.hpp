// program_cache.hpp -- keeps compiled kernels by their source and options.
#pragma once
#include <CL/opencl.hpp>
#include <atomic>
#include <list>
#include <memory>
#include <optional>
#include <string>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "device/device.hpp"
#include "kernels/kernel_arguments.hpp"
#include "kernels/kernel_source.hpp"

namespace clarity {

class TraceProgram {
 public:
    TraceProgram(const KernelSource& source, cl::Program compiled);
    const KernelRow& row;  // of the kernel that traces; the program may have other kernels too
    cl::Program program;
    double compile_ms = 0;
    // Of tried_program(): whether the kernels may run; why they may not.
    bool tried = false;
    std::optional<Error> refused;
    // Returns a new object of a kernel that the row's file declares: by default the row's. Throws cl::Error.
    KernelArguments kernel(const char* entry = nullptr) const;

 private:
    std::string declarations_;
    ArgumentMacros macros_;
};

// The options with which a kernel is compiled for a device.
std::string options_for(const DeviceInfo& info, const KernelSource& source);

// The programs most recently used on one device. Switching a setting back compiles nothing.
class ProgramCache {
 public:
    explicit ProgramCache(std::shared_ptr<Device> device) : device_(std::move(device)) {}
    ~ProgramCache();
    // Compiles the program if it is not kept. *fresh: whether it was compiled now. Throws Error(kernel_build_failed), and
    // Cancelled.
    std::shared_ptr<TraceProgram> get(const KernelSource& source, bool* fresh = nullptr);
    std::shared_ptr<TraceProgram> get(const KernelSource& source, bool* fresh, Progress& progress);
    std::shared_ptr<Device> device() const { return device_; }
    unsigned compiled() const { return compiled_; }  // programs compiled so far

 private:
    static constexpr size_t kKept = 32;
    struct Entry {
        std::string key;
        std::shared_ptr<TraceProgram> program;
    };
    std::shared_ptr<Device> device_;
    std::list<Entry> entries_;  // most recently used first
    uint64_t text_revision_ = 0;
    std::atomic<unsigned> compiled_{0};
};

}  // namespace clarity
