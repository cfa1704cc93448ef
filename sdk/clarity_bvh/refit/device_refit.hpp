// device_refit.hpp -- what a refit on the device (rt_device.h) needs of wide nodes: the positions below each, and the plan of a
// kernel that is made of cl/build/fit_nodes.h.
#pragma once
#include <algorithm>

#include "clarity_bvh/refit/refit.hpp"
#include "clarity_bvh/topology.hpp"
#include "rt_device.hpp"

namespace clarity::bvh {

// An rt_device_build::ranges for nodes in depth-first order, where a child comes after its parent. codes(node): the node's
// children as topology.hpp has them, any range. Returns RT_FAILED, with the error recorded, if positions below a node do not
// stand side by side.
template <class Codes>
int32_t find_ranges(const rt_host* host, const rt_built* built, rt_u32 group, rt_tree_ranges* out, Codes&& codes) {
    rt_refit_input roots{};
    roots.group_count = built->group_count;
    roots.roots = built->roots;
    const uint32_t root = built->roots[group], end = GroupEnds(&roots, built->slot_counts[0]).end_of(root);
    out->first_element = root;
    out->element_count = end - root;
    for (uint32_t at = end; at-- > root;) {
        uint64_t first = ~uint64_t{0}, last = 0, count = 0;
        for (const uint32_t child : codes(at)) {
            if (child == kEmpty) continue;
            const bool leaf = is_leaf(child);
            const uint32_t begin = leaf ? leaf_first(child) : out->ranges[2 * uint64_t{child}];
            const uint32_t below = leaf ? leaf_count(child) : out->ranges[2 * uint64_t{child} + 1];
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

// An rt_device_build::refit by one kernel of the plugin's. cost: of a ray.
inline int32_t plan_refit(const rt_device_plan* plan, const char* kernel, const rt_device_tree* tree, rt_u32 blocks,
                          rt_u32 costs, const RefitCosts& cost) {
    using rt::number;
    using rt::of;
    using rt::real;
    const uint64_t each = rt::elements_each(plan), elements = tree->element_count[0];
    rt::DeviceSteps steps(plan);
    steps.launch(kernel, (elements + each - 1) / each,
                 {of(tree->slots[0]), of(tree->ranges), of(blocks), number(tree->count), number(tree->first_element[0]),
                  number(elements), number(each), number(tree->first_leaf), number(tree->root),
                  real(static_cast<float>(cost.node)), real(static_cast<float>(cost.primitive)), of(costs)});
    return steps.result();
}

}  // namespace clarity::bvh
