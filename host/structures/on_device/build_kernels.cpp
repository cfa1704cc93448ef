#include "structures/on_device/build_kernels.hpp"

#include <algorithm>

#include "compile/compile.hpp"
#include "device/cl_errors.hpp"
#include "device/kernel_files.hpp"

namespace clarity {
namespace {

// CL_DEVICE_COMPUTE_CAPABILITY_MAJOR_NV of the extension cl_nv_device_attribute_query.
constexpr cl_device_info kComputeCapability = 0x4000;

// NVIDIA's instructions for warps, as groups.h uses them, came with compute capability 7.
bool has_warps(const DeviceInfo& info) {
    cl_uint major = 0;
    return info.nvidia && clGetDeviceInfo(info.cl_device(), kComputeCapability, sizeof major, &major, nullptr) == CL_SUCCESS &&
           major >= 7;
}

}  // namespace

BuildKernels::BuildKernels(std::shared_ptr<Device> device, BuildForm form)
    : device_(std::move(device)),
      serial_(form == BuildForm::serial || (form == BuildForm::automatic && device_->info().cpu)),
      warps_(!serial_ && has_warps(device_->info())) {}

cl::Program BuildKernels::compile(const std::string& text, const std::string& what, const std::string& more_options) const {
    std::string options =
        "-cl-std=CL1.2 -DRT_GROUP=" + std::to_string(group()) + " -DRT_SCAN_TILE=" + std::to_string(scan_tile()) + "u";
    if (warps_) options += " -DRT_WARPS";
    std::string headers;
    for (const std::string name : {"build/groups.h", "build/blocks.h"})
        headers += "#line 1 \"cl/" + name + "\"\n" + kernel_text(name);
    if (!more_options.empty()) options += " " + more_options;
    cl::Program& program = programs_[options + "\n" + headers + text];
    if (!program()) {
        Progress never_cancelled;
        program = compile_program(*device_, {headers + text, options, what}, never_cancelled).program;
    }
    return program;
}

cl::Program BuildKernels::compile_file(const std::string& name, const std::string& more_options) const {
    return compile("#line 1 \"cl/build/" + name + "\"\n" + kernel_text("build/" + name), "build/" + name, more_options);
}

cl::Event BuildKernels::launch(const cl::Kernel& kernel, size_t groups) const {
    cl::Event done;
    device_->queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(groups * group()), cl::NDRange(group()), nullptr,
                                          &done);
    return done;
}

cl::Buffer BuildKernels::buffer(size_t bytes) const {
    return wrap_cl_errors(*device_, "allocating memory for builds",
                          [&] { return cl::Buffer(device_->context(), CL_MEM_READ_WRITE, std::max<size_t>(bytes, 256)); });
}

}  // namespace clarity
