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
    reduce_boxes_ = cl::Kernel(program, "reduce_boxes");
    reduce_parts_ = cl::Kernel(program, "reduce_parts");
    all_parts_ = kernels.buffer(most_groups_ * sizeof(DeviceBounds));
    parts_ = kernels.buffer(kFewParts * sizeof(DeviceBounds));
    bytes_ = (most_groups_ + kFewParts) * sizeof(DeviceBounds);
}

void DeviceReduce::run(const cl::Buffer& boxes, uint64_t first, uint64_t count, const cl::Buffer& result) {
    join(reduce(boxes, first, count, all_parts_), result);
}

uint64_t DeviceReduce::run_parts(const cl::Buffer& boxes, uint64_t first, uint64_t count) {
    if (groups_for(count) <= kFewParts) return reduce(boxes, first, count, parts_);
    run(boxes, first, count, parts_);
    return 1;
}

uint64_t DeviceReduce::groups_for(uint64_t count) const {
    const uint64_t each = std::max(kLeastBoxes, (count + most_groups_ - 1) / most_groups_);
    return std::max<uint64_t>((count + each - 1) / each, 1);
}

uint64_t DeviceReduce::reduce(const cl::Buffer& boxes, uint64_t first, uint64_t count, const cl::Buffer& parts) {
    const uint64_t groups = groups_for(count);
    reduce_boxes_.setArg(0, boxes);
    reduce_boxes_.setArg(1, static_cast<cl_uint>(first));
    reduce_boxes_.setArg(2, static_cast<cl_uint>(count));
    reduce_boxes_.setArg(3, static_cast<cl_uint>((count + groups - 1) / groups));
    reduce_boxes_.setArg(4, parts);
    kernels_.launch(reduce_boxes_, groups);
    return groups;
}

void DeviceReduce::join(uint64_t parts, const cl::Buffer& result) {
    reduce_parts_.setArg(0, all_parts_);
    reduce_parts_.setArg(1, static_cast<cl_uint>(parts));
    reduce_parts_.setArg(2, result);
    kernels_.launch(reduce_parts_, 1);
}

}  // namespace clarity
