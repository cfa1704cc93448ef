#include "device_build.hpp"

#include <algorithm>

#include "clarity_bvh/parameters.hpp"
#include "clarity_bvh/refit/refit.hpp"
#include "clarity_bvh/wide/wide_build.hpp"
#include "node_memory.hpp"
#include "rt_device.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh4_types.h"

namespace bvh4 {
namespace {

using rt::number;
using rt::of;

// The most primitives of a subtree in which the second and the third pass begin. A level of a pass then has fewer than 1024
// nodes (BVH4_LEVEL): trees have less than 2^28 primitives.
constexpr uint64_t kMiddle = 1u << 18, kLow = 1u << 9;
constexpr uint64_t kGroupsPerUnit = 16;  // work-groups of a pass over many subtrees

}  // namespace

// A node of fewer than four children has leaves only, of two primitives or more together. A node of four has at most one below
// it for every three primitives. So two nodes for three primitives are the worst.
uint64_t device_elements(rt_u32, uint64_t count, const double*) {
    return 2 * count / 3 + 1;
}

int32_t device_pack(const rt_host*, const rt_device_plan* plan, const rt_device_input* input,
                    const rt_device_topology* topology, const rt_device_tree* tree, const rt_device_output* out) {
    const uint64_t n = input->count, each = rt::elements_each(plan), binaries = std::max<uint64_t>(n, 2) - 1;
    const uint64_t list = 4 * n + 32, many = plan->units * kGroupsPerUnit;  // disjoint subtrees of two primitives or more
    const uint32_t max_leaf = clarity::bvh::wide_rules(input->params).max_leaf;
    rt::DeviceSteps steps(plan);
    const rt_u32 roots = steps.buffer(list), middles = steps.buffer(n > kMiddle ? list : 32), lows = steps.buffer(list);
    const rt_u32 children = steps.buffer(32 * binaries), wide = steps.buffer(4 * (binaries + 1));
    const auto pass = [&](rt_u32 from, rt_u32 to, uint64_t groups, uint64_t least) {
        steps.launch("bvh4_open", groups,
                     {of(topology->nodes), of(topology->counts), number(max_leaf), number(least), of(from), of(to),
                      of(children), of(wide)});
    };
    steps.fill(wide, binaries + 1, 0);
    steps.launch("bvh4_begin", 1, {number(n), of(roots), of(middles), of(lows), of(children), of(wide)});
    if (n > kMiddle) {
        pass(roots, middles, 1, kMiddle);
        pass(middles, lows, many, kLow);
    } else if (n > kLow) {
        pass(roots, lows, 1, kLow);
    }
    if (n > 1) pass(n > kLow ? lows : roots, middles, n > kLow ? many : 1, max_leaf);
    steps.scan(wide, binaries + 1);
    const uint64_t elements = tree->element_count[0];
    steps.launch("bvh4_write", (std::max(binaries, elements) + each - 1) / each,
                 {of(input->prims), of(topology->nodes), of(topology->counts), of(topology->order), number(n), number(binaries),
                  number(elements), number(each), number(max_leaf), of(children), of(wide), number(tree->first_element[0]),
                  number(tree->first_leaf), of(tree->slots[0]), of(tree->ranges), of(out->leaves)});
    out->root(out->ctx, static_cast<rt_u32>(tree->first_element[0]));
    out->define(out->ctx, "BVH4_STACK", clarity::bvh::stack_places(3 * topology->depth));
    return steps.result();
}

// Nodes stand in depth-first order, so a child comes after its parent.
int32_t device_ranges(const rt_host* host, const rt_built* built, rt_u32 group, rt_tree_ranges* out) {
    const auto* const nodes = static_cast<const clarity::bvh::WideNode<4>*>(built->slots[0]);
    rt_refit_input roots{};
    roots.group_count = built->group_count;
    roots.roots = built->roots;
    const uint32_t root = built->roots[group], end = clarity::bvh::GroupEnds(&roots, built->slot_counts[0]).end_of(root);
    out->first_element = root;
    out->element_count = end - root;
    for (uint32_t at = end; at-- > root;) {
        uint64_t first = ~uint64_t{0}, last = 0, count = 0;
        for (const uint32_t child : settled_node(nodes, at).child) {
            if (child == clarity::bvh::kEmpty) continue;
            const bool leaf = clarity::bvh::is_leaf(child);
            const uint32_t begin = leaf ? clarity::bvh::leaf_first(child) : out->ranges[2 * uint64_t{child}];
            const uint32_t below = leaf ? clarity::bvh::leaf_count(child) : out->ranges[2 * uint64_t{child} + 1];
            first = std::min<uint64_t>(first, begin);
            last = std::max<uint64_t>(last, uint64_t{begin} + below);
            count += below;
        }
        if (count == 0) continue;
        if (last - first != count) return host->fail(host->ctx, "the positions below a node do not stand side by side");
        out->ranges[2 * uint64_t{at}] = static_cast<rt_u32>(first);
        out->ranges[2 * uint64_t{at} + 1] = static_cast<rt_u32>(count);
    }
    return RT_OK;
}

int32_t device_refit(const rt_host*, const rt_device_plan* plan, const rt_device_tree* tree, rt_u32 blocks, rt_u32 costs,
                     const double* params) {
    const clarity::bvh::Rules rules = clarity::bvh::wide_rules(params);
    const uint64_t each = rt::elements_each(plan), elements = tree->element_count[0];
    rt::DeviceSteps steps(plan);
    steps.launch(
        "bvh4_refit", (elements + each - 1) / each,
        {of(tree->slots[0]), of(tree->ranges), of(blocks), number(tree->count), number(tree->first_element[0]),
         number(elements), number(each), number(tree->first_leaf), number(tree->root),
         rt::real(static_cast<float>(rules.traversal_cost)), rt::real(static_cast<float>(rules.intersection_cost)), of(costs)});
    return steps.result();
}

}  // namespace bvh4
