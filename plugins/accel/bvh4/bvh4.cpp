// bvh4.cpp -- the plugin of the BVH with four children a node, for single rays on GPUs: its table and its build entry.
//
// The nodes of a binary tree are merged by the surface area heuristic. A node takes 128 bytes; a triangle takes 66 to 68 bytes,
// its own record included. A GPU thread has registers for four boxes at once, which seven loads fetch. In a binary tree, the
// thread would wait for twice as many dependent fetches.
#include <iterator>

#include "clarity_bvh/assemble.hpp"
#include "clarity_bvh/parameters.hpp"
#include "clarity_bvh/wide/wide_levels.hpp"
#include "device_build.hpp"
#include "node_memory.hpp"
#include "pack.hpp"
#include "refit.hpp"
#include "rt_device.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh4_types.h"

namespace bvh4 {
namespace {

using namespace clarity::bvh;

constexpr rt_cl_file kFiles[] = {
#include "bvh4.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<bvh4_node>("bvh4_nodes", "bvh4_node")};
static_assert(sizeof(bvh4_node) == 128, "a node is a line of a GPU's cache");
constexpr rt_cl_file kTypes = rt::file(kFiles, "bvh4_types.h"), kTraversal = rt::file(kFiles, "bvh4.cl");
constexpr rt::Traits kTraits =
    rt::Traits().can(RT_TRAVERSES_STEPS | RT_TRAVERSES_WARPS | RT_REQUEUES_LONG_RAYS).merit(0.75f, 1.64f);

constexpr rt_param kParams[] = {
    max_leaf_param(BVH4_LEAF_MAX, 4),
    bins_param(),
    traversal_param(3),
    intersection_param(1),
    builder_param(),
    duplicates_param(),
};
static_assert(std::size(kParams) == kOwnParams, "in the order of WideParam");

int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    const auto* nodes = static_cast<const WideNode<4>*>(built->slots[0]);
    show_wide_level(host, built, group, level, sink, [&](rt_u32 at) { return settled_node(nodes, at); });
    return RT_OK;
}

constexpr rt_accel kAccel = rt::accel(kSlots, kTypes, kTraversal, rt::guarded<build>, rt::guarded<levels>, kTraits,
                                      rt::guarded<pack_trees<pack, BVH4_LEAF_MAX>>);
constexpr rt_refit kRefit = rt::refit(rt::guarded<refit>);
constexpr rt_device_build kDeviceBuild =
    rt::device_layout(rt::file(kFiles, "bvh4_build.cl"), device_elements, rt::guarded<device_pack>, rt::guarded<device_ranges>,
                      rt::guarded<device_refit>);
constexpr rt_extension kExtensions[] = {rt::extension(kRefit), rt::extension(kDeviceBuild), rt::kNoMoreExtensions};
static_assert(kAccel.types.text && kAccel.traverse.text && kDeviceBuild.kernels.text, "the kernel files are embedded");

}  // namespace
}  // namespace bvh4

const rt_plugin rt_plugin_v1 =
    rt::with_extensions(rt::accel_plugin("bvh4", "4-wide BVH for GPUs (binned SAH, collapsed)", "1.0.0",
                                         "Wald, Benthin, Boulos 2008, Getting Rid of Packets: Efficient SIMD "
                                         "Single-Ray Traversal using Multi-branching BVHs",
                                         bvh4::kParams, bvh4::kAccel),
                        bvh4::kExtensions);
