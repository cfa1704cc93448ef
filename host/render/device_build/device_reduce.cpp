#include "render/device_build/device_reduce.hpp"

#include <algorithm>

namespace clarity {
namespace {

// Work-groups of a device's unit, so that its memory is busy.
constexpr uint64_t kGroupsPerUnit = 8;
constexpr uint64_t kLeastBoxes = 512;  // of a work-group

}  // namespace

DeviceReduce::DeviceReduce(const BuildKernels& kernels)
    : kernels_(kernels), most_groups_(std::max(1u, kernels.device().info().compute_units) * kGroupsPerUnit) {
    const cl::Program program = kernels.compile_file("reduce.cl");
    boxes_ = cl::Kernel(program, "reduce_boxes");
    parts_ = cl::Kernel(program, "reduce_parts");
    bytes_ = most_groups_ * sizeof(DeviceBounds);
    bounds_ = kernels.buffer(bytes_);
}

void DeviceReduce::run(const cl::Buffer& boxes, uint64_t first, uint64_t count, const cl::Buffer& result) {
    const uint64_t each = std::max(kLeastBoxes, (count + most_groups_ - 1) / most_groups_);
    const uint64_t groups = std::max<uint64_t>((count + each - 1) / each, 1);
    boxes_.setArg(0, boxes);
    boxes_.setArg(1, static_cast<cl_uint>(first));
    boxes_.setArg(2, static_cast<cl_uint>(count));
    boxes_.setArg(3, static_cast<cl_uint>(each));
    boxes_.setArg(4, bounds_);
    kernels_.launch(boxes_, groups);
    parts_.setArg(0, bounds_);
    parts_.setArg(1, static_cast<cl_uint>(groups));
    parts_.setArg(2, result);
    kernels_.launch(parts_, 1);
}

}  // namespace clarity
