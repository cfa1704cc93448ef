#include "render/device_build/device_blocks.hpp"

namespace clarity {
namespace {

constexpr uint64_t kBlocksAtOnce = 256;  // of a work-group of make_blocks
constexpr unsigned kSizesAtOnce = 8;

}  // namespace

DeviceBlocks::DeviceBlocks(const BuildKernels& kernels)
    : kernels_(kernels), make_(kernels.compile_file("blocks.cl"), "make_blocks") {}

void DeviceBlocks::run(const cl::Buffer& boxes, const cl::Buffer* order, uint64_t count, const cl::Buffer& result) {
    uint64_t begin = 0, blocks = count;
    for (unsigned size = 0; blocks > 0 && (size == 0 || blocks > 1); size += kSizesAtOnce) {
        make_.setArg(0, boxes);
        make_.setArg(1, order ? *order : boxes);
        make_.setArg(2, cl_uint{order != nullptr});
        make_.setArg(3, cl_uint{size});
        make_.setArg(4, static_cast<cl_uint>(begin));
        make_.setArg(5, static_cast<cl_uint>(blocks));
        make_.setArg(6, result);
        kernels_.launch(make_, (blocks + kBlocksAtOnce - 1) / kBlocksAtOnce);
        for (unsigned s = 0; s < kSizesAtOnce && blocks > 1; ++s) {
            begin += blocks;
            blocks = (blocks + 1) / 2;
        }
    }
}

}  // namespace clarity
