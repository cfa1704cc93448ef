// bvh4.cpp -- the plugin of the BVH with four children a node, for single rays on GPUs: its table and its build entry.
//
// The nodes of a binary tree are merged by the surface area heuristic. A node takes 128 bytes; a triangle takes 66 to 68 bytes,
// its own record included. A GPU thread has registers for four boxes at once, which seven loads fetch. In a binary tree, the
// thread would wait for twice as many dependent fetches.
#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <vector>

#include "clarity_bvh/assemble.hpp"
#include "clarity_bvh/levels.hpp"
#include "clarity_bvh/parameters.hpp"
#include "clarity_bvh/refit/device_refit.hpp"
#include "clarity_bvh/refit/refit_wide.hpp"
#include "clarity_bvh/wide/wide_build.hpp"
#include "clarity_bvh/wide/wide_node.hpp"
#include "node_memory.hpp"
#include "pack.hpp"
#include "rt_device.h"
#include "rt_device.hpp"
#include "rt_plugin.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh4_types.h"

namespace bvh4 {
namespace {

using namespace clarity::bvh;

// Plans on the device: a binary tree becomes nodes of four children, and such nodes are refitted.
// bvh4_build.cl has the kernels.

using rt::number;
using rt::of;

// Of kernel memory: what a binary node takes in, and a node that is to be written (bvh4_build.cl).
constexpr uint64_t kChoiceBytes = 32, kTaskBytes = 8;

// The functions of rt_device_build.
// A node of fewer than four children has leaves only, of two primitives or more together. A node of four has at most one below
// it for every three primitives. So two nodes for three primitives are the worst.
uint64_t device_elements(rt_u32, uint64_t count, const double*) {
    return 2 * count / 3 + 1;
}

int32_t device_pack(const rt_host*, const rt_device_plan* plan, const rt_device_input* input,
                    const rt_device_topology* topology, const rt_device_tree* tree, const rt_device_output* out) {
    const uint64_t n = input->count, each = rt::elements_each(plan), elements = tree->element_count[0];
    const uint32_t max_leaf = wide_rules(input->params).max_leaf;
    const bool has_root = topology->root != RT_NONE;
    rt::DeviceSteps steps(plan);
    const rt_u32 choices = steps.buffer(kChoiceBytes * n), used = steps.buffer(4), tasks = steps.buffer(kTaskBytes * elements),
                 below = steps.buffer(4 * n);
    const auto launch = [&](const char* kernel, uint64_t items, std::initializer_list<rt_device_arg> more) {
        std::vector<rt_device_arg> args = {of(input->prims),    of(topology->nodes), of(topology->counts),
                                           of(topology->order), number(max_leaf),    number(n)};
        args.insert(args.end(), more);
        steps.launch(kernel, (items + each - 1) / each, args);
    };
    launch("bvh4_choose", std::max<uint64_t>(n, 1), {number(each), of(choices), of(used)});
    launch("bvh4_number", std::max<uint64_t>(n, 1),
           {number(each), of(choices), of(has_root ? topology->root : used), number(has_root), of(used), of(tasks), of(below),
            of(out->leaves)});
    launch("bvh4_write", elements,
           {number(elements), number(each), of(choices), of(used), of(tasks), of(below), number(tree->first_element[0]),
            number(tree->first_leaf), of(tree->slots[0]), of(tree->ranges)});
    out->root(out->ctx, static_cast<rt_u32>(tree->first_element[0]));
    out->define(out->ctx, "BVH4_STACK", stack_places(3 * topology->depth));
    return steps.result();
}

int32_t device_ranges(const rt_host* host, const rt_built* built, rt_u32 group, rt_tree_ranges* out) {
    const auto* const nodes = static_cast<const WideNode<4>*>(built->slots[0]);
    return find_ranges(host, built, group, out, [&](uint32_t at) {
        std::array<uint32_t, 4> codes;
        const WideNode<4> node = settled_node(nodes, at);
        std::copy_n(node.child, codes.size(), codes.begin());
        return codes;
    });
}

int32_t device_refit(const rt_host*, const rt_device_plan* plan, const rt_device_tree* tree, rt_u32 blocks, rt_u32 costs,
                     const double* params) {
    const Rules rules = wide_rules(params);
    return plan_refit(plan, "bvh4_refit", tree, blocks, costs, {rules.traversal_cost, rules.intersection_cost});
}

// The extension `refit` of bvh4: new volumes for primitives that moved, in the same tree.

// Rows stand where settle() has put them, and children are the addresses that it made.
struct Rows {
    static constexpr uint32_t kWidth = 4, kBlock = 128;
    float* nodes;
    float* plane(uint32_t at, uint32_t k) const { return row(at, k); }
    uint32_t child(uint32_t at, uint32_t slot) const {
        uint32_t code;
        std::memcpy(&code, row(at, 6) + slot, sizeof code);
        return is_leaf(code) ? code : BVH4_INDEX(code);
    }

 private:
    float* row(uint32_t at, uint32_t k) const { return nodes + 32 * uint64_t{at} + 4 * (k ^ (at & 7u)); }
};
static_assert(sizeof(bvh4_node) == 32 * sizeof(float), "eight rows of four numbers");

int32_t refit(const rt_host* host, const rt_refit_input* in, const rt_refit_output* out) {
    WideRefit<Rows> layout({static_cast<float*>(out->slots[0])}, in->slot_counts[0], in);
    const Rules rules = wide_rules(in->params);
    Refit<WideRefit<Rows>>(host, in, out, layout, {rules.traversal_cost, rules.intersection_cost}).run();
    return RT_OK;
}

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
    reinsert_param(),
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
