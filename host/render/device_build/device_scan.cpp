#include "render/device_build/device_scan.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace clarity {
namespace {

// One work-group takes so many tiles one after the other, before more groups and two more launches pay.
constexpr uint64_t kTilesOfOneGroup = 4;
// Work-groups of a CPU's unit. More of them balance the load, fewer leave less to do for the next level.
constexpr uint64_t kGroupsPerCpuUnit = 8;

}  // namespace

DeviceScan::DeviceScan(const BuildKernels& kernels, uint64_t most) : kernels_(kernels), most_(most) {
    const cl::Program program = kernels.compile_file("scan.cl");
    for (uint64_t count = most;; count = groups_for(count)) {
        const uint64_t sums = groups_for(count);
        levels_.push_back({kernels.buffer(4 * sums), cl::Kernel(program, "scan_sums"), cl::Kernel(program, "scan_tiles")});
        bytes_ += 4 * sums;
        if (sums == 1) break;
    }
}

uint64_t DeviceScan::tiles_each(uint64_t count) const {
    const uint64_t tiles = (count + kernels_.scan_tile() - 1) / kernels_.scan_tile();
    if (tiles <= kTilesOfOneGroup) return kTilesOfOneGroup;
    const uint64_t groups = uint64_t{kernels_.device().info().compute_units} * kGroupsPerCpuUnit;
    return kernels_.serial() ? (tiles + groups - 1) / groups : 1;
}

uint64_t DeviceScan::groups_for(uint64_t count) const {
    const uint64_t each = tiles_each(count) * kernels_.scan_tile();
    return std::max<uint64_t>((count + each - 1) / each, 1);
}

void DeviceScan::run(const cl::Buffer& data, uint64_t count) {
    if (count > most_)
        throw Error(Exit::failed, "a scan of " + std::to_string(count) + " numbers was asked for, with memory for " +
                                      std::to_string(most_) + " (a bug in the builder: please report it)");
    if (count > 0) scan(data, count, 0);
}

void DeviceScan::scan(const cl::Buffer& data, uint64_t count, size_t at) {
    Level& level = levels_[at];
    const uint64_t groups = groups_for(count);
    const auto numbers = static_cast<cl_uint>(count), each = static_cast<cl_uint>(tiles_each(count));
    if (groups > 1) {
        level.sum.setArg(0, data);
        level.sum.setArg(1, numbers);
        level.sum.setArg(2, each);
        level.sum.setArg(3, level.sums);
        kernels_.launch(level.sum, groups);
        scan(level.sums, groups, at + 1);
    }
    level.tiles.setArg(0, data);
    level.tiles.setArg(1, numbers);
    level.tiles.setArg(2, each);
    level.tiles.setArg(3, level.sums);
    level.tiles.setArg(4, cl_uint{groups > 1});
    kernels_.launch(level.tiles, groups);
}

}  // namespace clarity
