// bvh8.cpp -- the plugin of the BVH with eight children a node, the usual structure on a CPU: its table and its build entry.
//
// The nodes of a binary tree are merged by the surface area heuristic. A node takes 224 bytes; a triangle takes 58 to 60 bytes,
// its own record included. Both a single ray and the bounds of a coherent packet are tested against all eight children at once.
// The tree is shallow. A tree of only a few nodes is traced faster as bvh2, because packets there need no bounds.
#include "clarity_bvh/assemble.hpp"
#include "clarity_bvh/parameters.hpp"
#include "clarity_bvh/wide/wide_levels.hpp"
#include "incoherent.hpp"
#include "pack.hpp"
#include "refit.hpp"
#include "rt_device.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh8_types.h"

namespace bvh8 {
namespace {

using namespace clarity::bvh;

constexpr rt_cl_file kFiles[] = {
#include "bvh8.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<bvh8_node>("bvh8_nodes", "bvh8_node")};
static_assert(sizeof(bvh8_node) == 224, "rows are aligned vectors");
constexpr rt_cl_file kTypes = rt::file(kFiles, "bvh8_types.h"), kTraversal = rt::file(kFiles, "bvh8.cl");
constexpr rt::Traits kTraits = rt::Traits().can(RT_TRAVERSES_STREAMS | RT_SPLITS_INCOHERENT).merit(1.4f, 1.17f);

// Leaf size and cost that suit the kernels: a ray tests four triangles at the price of one, and the bounds of a packet spare it
// most leaves. Compared with leaves of four at a cost of 1, over the twelve views of the suite `cpu`: diffuse rays are 1.05
// times as fast, shadow rays 1.07, primary rays 1.03, and there are a third fewer nodes.
constexpr int kLeafSize = BVH8_LEAF_MAX;
constexpr double kLeafCost = 0.4;

constexpr rt_param kParams[] = {
    max_leaf_param(BVH8_LEAF_MAX, kLeafSize),
    bins_param(),
    traversal_param(3),
    intersection_param(kLeafCost),
    builder_param(),
    duplicates_param(),
    rt::enum_param(
        "incoherent", "Incoherent rays",
        "how a CPU traces packets whose rays part: packets: together; single: each alone; auto: alone where the tree "
        "is larger than its caches",
        kIncoherentWays, kAuto),
};

int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    const auto* nodes = static_cast<const WideNode<8>*>(built->slots[0]);
    show_wide_level(host, built, group, level, sink, [&](rt_u32 at) -> const WideNode<8>& { return nodes[at]; });
    return RT_OK;
}

constexpr rt_accel kAccel = rt::accel(kSlots, kTypes, kTraversal, rt::guarded<build>, rt::guarded<levels>, kTraits,
                                      rt::guarded<pack_trees<pack, BVH8_LEAF_MAX>>);
constexpr rt_refit kRefit = rt::refit(rt::guarded<refit>);
constexpr rt_device_build kDeviceRefit =
    rt::device_refit(rt::file(kFiles, "bvh8_build.cl"), rt::guarded<device_ranges>, rt::guarded<device_refit>);
constexpr rt_extension kExtensions[] = {rt::extension(kRefit), rt::extension(kDeviceRefit), rt::kNoMoreExtensions};
static_assert(kAccel.types.text && kAccel.traverse.text && kDeviceRefit.kernels.text, "the kernel files are embedded");

}  // namespace
}  // namespace bvh8

const rt_plugin rt_plugin_v1 =
    rt::with_extensions(rt::accel_plugin("bvh8", "8-wide BVH (binned SAH)", "1.0.0",
                                         "Wald, Benthin, Boulos 2008, Getting Rid of Packets: Efficient SIMD "
                                         "Single-Ray Traversal using Multi-branching BVHs",
                                         bvh8::kParams, bvh8::kAccel),
                        bvh8::kExtensions);
