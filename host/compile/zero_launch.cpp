#include "compile/zero_launch.hpp"

#include <vector>

namespace clarity {
namespace {

constexpr size_t kBufferBytes = 64 << 10, kLocalBytes = 16 << 10, kGroup = 64;
constexpr size_t kMostBytes = 128;  // of an argument by value: a vector of 16 doubles

// The size of an argument by value is not asked for in OpenCL 1.2; the driver refuses the wrong ones.
void set_zero(cl::Kernel& kernel, cl_uint at) {
    const char zeros[kMostBytes] = {};
    cl_int error = CL_INVALID_ARG_SIZE;
    for (size_t bytes = 1; bytes <= kMostBytes && error != CL_SUCCESS; bytes *= 2)
        error = clSetKernelArg(kernel(), at, bytes, zeros);
    if (error != CL_SUCCESS) throw cl::Error(error, "clSetKernelArg");
}

}  // namespace

void launch_on_zeros(Device& device, const cl::Program& program) {
    cl::Program compiled = program;
    std::vector<cl::Kernel> kernels;
    compiled.createKernels(&kernels);
    for (cl::Kernel& kernel : kernels) {
        std::vector<cl::Buffer> buffers;
        const auto count = kernel.getInfo<CL_KERNEL_NUM_ARGS>();
        for (cl_uint at = 0; at < count; ++at) {
            const auto space = kernel.getArgInfo<CL_KERNEL_ARG_ADDRESS_QUALIFIER>(at);
            if (space == CL_KERNEL_ARG_ADDRESS_PRIVATE) {
                set_zero(kernel, at);
            } else if (space == CL_KERNEL_ARG_ADDRESS_LOCAL) {
                kernel.setArg(at, cl::Local(kLocalBytes));
            } else {
                buffers.emplace_back(device.context(), CL_MEM_READ_WRITE, kBufferBytes);
                device.queue().enqueueFillBuffer(buffers.back(), cl_uint(0), 0, kBufferBytes);
                kernel.setArg(at, buffers.back());
            }
        }
        const cl::size_type required = kernel.getWorkGroupInfo<CL_KERNEL_COMPILE_WORK_GROUP_SIZE>(device.info().cl_device)[0];
        const size_t local = required ? required : kGroup;
        device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(local), cl::NDRange(local));
        device.queue().finish();
    }
}

}  // namespace clarity
