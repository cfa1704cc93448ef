// program_cache.hpp -- compiled kernels, kept by what they were compiled from.
#pragma once
#include <CL/opencl.hpp>
#include <atomic>
#include <list>
#include <memory>
#include <string>

#include "device/device.hpp"
#include "render/kernels/kernel_source.hpp"

namespace clarity {

class TraceProgram {
 public:
    cl::Program program;
    std::string entry;
    KernelKind kind = KernelKind::color;
    double compile_ms = 0;
    // Whether it traces more than camera rays, and so takes buffers for counters and distances.
    bool has_generations() const { return kind == KernelKind::color || kind == KernelKind::generations; }
    bool is_wavefront() const { return entry == kWavefrontEntry; }
    // Kernel objects hold arguments, so each user makes its own.
    cl::Kernel kernel() const { return cl::Kernel(program, entry.c_str()); }
};

// Programs by source and options, the most recently used ones; toggling a setting back is free.
class ProgramCache {
 public:
    explicit ProgramCache(std::shared_ptr<Device> device) : device_(std::move(device)) {}
    // fresh: whether it was compiled now.
    std::shared_ptr<TraceProgram> get(const KernelSource& source, KernelKind kind, const std::string& what, bool* fresh);
    std::shared_ptr<Device> device() const { return device_; }
    unsigned compiled() const { return compiled_; }

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
