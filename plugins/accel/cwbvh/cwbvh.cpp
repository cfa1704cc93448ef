// cwbvh.cpp -- the plugin of the compressed BVH with eight children a node, for scenes that fill a GPU's memory.
//
// It is an 8-wide tree with each box rounded outwards to a grid of 255 steps a node. A node takes 80 bytes; in bvh8 it takes
// 224. A triangle takes 55 bytes, its own record included; with bvh4 it takes 67.
#include <iterator>

#include "clarity_bvh/assemble.hpp"
#include "clarity_bvh/parameters.hpp"
#include "compressed_levels.hpp"
#include "pack.hpp"
#include "refit.hpp"
#include "rt_device.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "cwbvh_types.h"

namespace cwbvh {
namespace {

using namespace clarity::bvh;

constexpr rt_cl_file kFiles[] = {
#include "cwbvh.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<cwbvh_node>("cwbvh_nodes", "cwbvh_node")};
static_assert(sizeof(cwbvh_node) == 80, "five loads of 16 bytes");
constexpr rt_cl_file kTypes = rt::file(kFiles, "cwbvh_types.h"), kTraversal = rt::file(kFiles, "cwbvh.cl");

constexpr rt_param kParams[] = {
    max_leaf_param(CWBVH_LEAF_MAX, CWBVH_LEAF_MAX),
    bins_param(),
    traversal_param(3),
    intersection_param(1),
    builder_param(),
    duplicates_param(),
};
static_assert(std::size(kParams) == kOwnParams, "in the order of WideParam");

constexpr rt_accel kAccel = rt::accel(kSlots, kTypes, kTraversal, rt::guarded<build>, rt::guarded<levels>,
                                      rt::Traits().merit(0.5f, 1.35f), rt::guarded<pack_trees<pack, CWBVH_LEAF_MAX>>);

constexpr rt_refit kRefit = rt::refit(rt::guarded<refit>);
constexpr rt_device_build kDeviceRefit =
    rt::device_refit(rt::file(kFiles, "cwbvh_build.cl"), rt::guarded<device_ranges>, rt::guarded<device_refit>);
constexpr rt_extension kExtensions[] = {rt::extension(kRefit), rt::extension(kDeviceRefit), rt::kNoMoreExtensions};
static_assert(kAccel.types.text && kAccel.traverse.text && kDeviceRefit.kernels.text, "the kernel files are embedded");

}  // namespace
}  // namespace cwbvh

const rt_plugin rt_plugin_v1 =
    rt::with_extensions(rt::accel_plugin("cwbvh", "Compressed 8-wide BVH for GPUs (binned SAH)", "1.0.0",
                                         "Ylitie, Karras, Laine 2017, Efficient Incoherent Ray Traversal on GPUs "
                                         "Through Compressed Wide BVHs",
                                         cwbvh::kParams, cwbvh::kAccel),
                        cwbvh::kExtensions);
