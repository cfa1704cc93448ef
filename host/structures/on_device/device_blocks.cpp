#include "structures/on_device/device_blocks.hpp"

namespace clarity {
namespace {

constexpr unsigned kSizes = 8;  // RT_BLOCK_SIZES: that a launch adds
// One group makes all sizes above so many blocks. Several would be done with the first eight sizes sooner, but a launch more
// takes longer than the group needs.
constexpr uint64_t kForOneGroup = 2048;

}  // namespace

DeviceBlocks::DeviceBlocks(const BuildKernels& kernels) : kernels_(kernels) {
    const cl::Program program = kernels.compile_file("blocks.cl");
    make_ = cl::Kernel(program, "make_blocks");
    larger_ = cl::Kernel(program, "make_larger_blocks");
    unused_ = {kernels.buffer(kBytes), 0, kernels.buffer(kBytes)};
}

void DeviceBlocks::run(const cl::Buffer& boxes, const cl::Buffer* order, uint64_t count, const cl::Buffer& result) {
    if (count == 0) return;
    make_.setArg(0, boxes);
    make_.setArg(1, order ? *order : boxes);
    make_.setArg(2, cl_uint{order != nullptr});
    make_.setArg(3, static_cast<cl_uint>(count));
    make_.setArg(4, result);
    make_.setArg(5, unused_.block);
    make_.setArg(6, cl_uint{0});
    make_.setArg(7, unused_.bounds);
    kernels_.launch(make_, (count + kTile - 1) / kTile);
    run_above(count, result, unused_);
}

void DeviceBlocks::run_above(uint64_t count, const cl::Buffer& result, const Whole& whole) {
    uint64_t begin = 0, blocks = count;
    const auto rise = [&] {
        for (unsigned s = 0; s < kSizes && blocks > 1; ++s) {
            begin += blocks;
            blocks = (blocks + 1) / 2;
        }
    };
    rise();
    while (blocks > 1) {
        larger_.setArg(0, static_cast<cl_uint>(begin));
        larger_.setArg(1, static_cast<cl_uint>(blocks));
        larger_.setArg(2, result);
        larger_.setArg(3, whole.block);
        larger_.setArg(4, whole.at);
        larger_.setArg(5, whole.bounds);
        const bool one_group = blocks <= kForOneGroup;
        kernels_.launch(larger_, one_group ? 1 : (blocks + kTile - 1) / kTile);
        if (one_group) break;
        rise();
    }
}

}  // namespace clarity
