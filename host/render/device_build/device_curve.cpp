#include "render/device_build/device_curve.hpp"

#include "device/kernel_files.hpp"

namespace clarity {
namespace {

constexpr uint64_t kSerialBoxes = 4096;  // that a work-group of one work-item takes

}  // namespace

DeviceCurve::DeviceCurve(const BuildKernels& kernels, uint64_t most, unsigned axis_bits)
    : kernels_(kernels), axis_bits_(axis_bits), reduce_(kernels), sort_(kernels, most, SortKeys::bits64) {
    const cl::Program program = kernels.compile(
        kernel_text("build/reduce.cl") + "#line 1 \"cl/build/curve.cl\"\n" + kernel_text("build/curve.cl"), "build/curve.cl");
    codes_ = cl::Kernel(program, "curve_codes");
}

void DeviceCurve::run(const cl::Buffer& boxes, uint64_t count, const cl::Buffer& keys, const cl::Buffer& order) {
    if (count == 0) return;
    const uint64_t parts = reduce_.run_parts(boxes, 0, count), each = kernels_.serial() ? kSerialBoxes : kernels_.group();
    const DeviceSort::Pairs sorted = {keys, order}, unsorted = sort_.input(sorted, 3 * axis_bits_);
    codes_.setArg(0, boxes);
    codes_.setArg(1, static_cast<cl_uint>(count));
    codes_.setArg(2, static_cast<cl_uint>(each));
    codes_.setArg(3, cl_uint{axis_bits_});
    codes_.setArg(4, reduce_.parts());
    codes_.setArg(5, static_cast<cl_uint>(parts));
    codes_.setArg(6, unsorted.keys);
    codes_.setArg(7, unsorted.values);
    kernels_.launch(codes_, (count + each - 1) / each);
    sort_.run_into(sorted, count, 3 * axis_bits_);
}

}  // namespace clarity
