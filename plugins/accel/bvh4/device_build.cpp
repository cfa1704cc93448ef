#include "device_build.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "clarity_bvh/parameters.hpp"
#include "clarity_bvh/refit/device_refit.hpp"
#include "clarity_bvh/wide/wide_build.hpp"
#include "node_memory.hpp"
#include "rt_device.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh4_types.h"

namespace bvh4 {
namespace {

using rt::number;
using rt::of;

// Of kernel memory: what a binary node takes in, and a node that is to be written (bvh4_build.cl).
constexpr uint64_t kChoiceBytes = 32, kTaskBytes = 8;

}  // namespace

// A node of fewer than four children has leaves only, of two primitives or more together. A node of four has at most one below
// it for every three primitives. So two nodes for three primitives are the worst.
uint64_t device_elements(rt_u32, uint64_t count, const double*) {
    return 2 * count / 3 + 1;
}

int32_t device_pack(const rt_host*, const rt_device_plan* plan, const rt_device_input* input,
                    const rt_device_topology* topology, const rt_device_tree* tree, const rt_device_output* out) {
    const uint64_t n = input->count, each = rt::elements_each(plan), elements = tree->element_count[0];
    const uint32_t max_leaf = clarity::bvh::wide_rules(input->params).max_leaf;
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
    out->define(out->ctx, "BVH4_STACK", clarity::bvh::stack_places(3 * topology->depth));
    return steps.result();
}

int32_t device_ranges(const rt_host* host, const rt_built* built, rt_u32 group, rt_tree_ranges* out) {
    const auto* const nodes = static_cast<const clarity::bvh::WideNode<4>*>(built->slots[0]);
    return clarity::bvh::find_ranges(host, built, group, out, [&](uint32_t at) {
        std::array<uint32_t, 4> codes;
        const clarity::bvh::WideNode<4> node = settled_node(nodes, at);
        std::copy_n(node.child, codes.size(), codes.begin());
        return codes;
    });
}

int32_t device_refit(const rt_host*, const rt_device_plan* plan, const rt_device_tree* tree, rt_u32 blocks, rt_u32 costs,
                     const double* params) {
    const clarity::bvh::Rules rules = clarity::bvh::wide_rules(params);
    return clarity::bvh::plan_refit(plan, "bvh4_refit", tree, blocks, costs, {rules.traversal_cost, rules.intersection_cost});
}

}  // namespace bvh4
