// bvh8.cpp -- the plugin of the BVH with eight children a node, the usual structure on a CPU: its table and its build entry.
//
// The nodes of a binary tree are merged by the surface area heuristic. A node takes 224 bytes; a triangle takes 58 to 60 bytes,
// its own record included. Both a single ray and the bounds of a coherent packet are tested against all eight children at once.
// The tree is shallow. A tree of only a few nodes is traced faster as bvh2, because packets there need no bounds.
#include "clarity_bvh/assemble.hpp"
#include "clarity_bvh/levels.hpp"
#include "clarity_bvh/parameters.hpp"
#include "clarity_bvh/refit/device_refit.hpp"
#include "clarity_bvh/refit/refit_wide.hpp"
#include "clarity_bvh/wide/wide_node.hpp"
#include "incoherent.hpp"
#include "pack.hpp"
#include "rt_device.h"
#include "rt_device.hpp"
#include "rt_plugin.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh8_types.h"

namespace bvh8 {
namespace {

using namespace clarity::bvh;

// The extension `refit` of bvh8: new volumes for primitives that moved, in the same tree.
struct Rows {
    static constexpr uint32_t kWidth = 8, kBlock = 64;
    WideNode<8>* nodes;
    float* plane(uint32_t at, uint32_t k) const { return nodes[at].plane[k]; }
    uint32_t child(uint32_t at, uint32_t slot) const { return nodes[at].child[slot]; }
};

int32_t refit(const rt_host* host, const rt_refit_input* in, const rt_refit_output* out) {
    WideRefit<Rows> layout({static_cast<WideNode<8>*>(out->slots[0])}, in->slot_counts[0], in);
    const Rules rules = wide_rules(in->params);
    Refit<WideRefit<Rows>>(host, in, out, layout, {rules.traversal_cost, rules.intersection_cost}).run();
    return RT_OK;
}

// On the device: see rt_device.h.
int32_t device_ranges(const rt_host* host, const rt_built* built, rt_u32 group, rt_tree_ranges* out) {
    const auto* const nodes = static_cast<const WideNode<8>*>(built->slots[0]);
    return find_ranges(host, built, group, out, [&](uint32_t at) -> const auto& { return nodes[at].child; });
}

int32_t device_refit(const rt_host*, const rt_device_plan* plan, const rt_device_tree* tree, rt_u32 blocks, rt_u32 costs,
                     const double* params) {
    const Rules rules = wide_rules(params);
    return plan_refit(plan, "bvh8_refit", tree, blocks, costs, {rules.traversal_cost, rules.intersection_cost});
}

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
    reinsert_param(),
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
