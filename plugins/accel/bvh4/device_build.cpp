#include "device_build.hpp"

#include <algorithm>
#include <array>
#include <iterator>
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

// The most primitives of the subtrees to which the passes descend. A level of a pass has fewer than 1024 nodes then
// (BVH4_LEVEL): trees have less than 2^28 primitives. Each of the smallest is made by one work-item (BVH4_PENDING).
constexpr uint64_t kSubtrees[] = {1u << 22, 1u << 12, 1u << 4};
constexpr uint64_t kGroupsPerUnit = 16;  // work-groups of a pass over many subtrees or leaves

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
    // Lists of subtrees, which do not overlap: the first has the root alone, the others a subtree for two primitives at most.
    const bool has_root = topology->root != RT_NONE;
    const uint64_t places = n / 2 + 1, passes = std::size(kSubtrees);
    rt::DeviceSteps steps(plan);
    const rt_u32 lists = steps.buffer(16 * (2 + passes * places)), used = steps.buffer(4),
                 open_leaves = steps.buffer(8 * places);
    const auto launch = [&](const char* kernel, uint64_t groups, std::initializer_list<rt_device_arg> more) {
        std::vector<rt_device_arg> args = {of(input->prims),
                                           of(topology->nodes),
                                           of(topology->counts),
                                           of(topology->order),
                                           number(max_leaf),
                                           number(tree->first_element[0]),
                                           number(tree->first_leaf),
                                           of(tree->slots[0]),
                                           of(tree->ranges),
                                           of(out->leaves),
                                           of(used),
                                           of(open_leaves)};
        args.insert(args.end(), more);
        steps.launch(kernel, groups, args);
    };
    launch("bvh4_begin", (elements + each - 1) / each,
           {number(n), number(elements), number(each), of(has_root ? topology->root : used), number(has_root), of(lists),
            number(passes), number(places)});
    uint64_t from = 0, groups = 1;
    for (size_t pass = 0; pass < passes; ++pass) {
        if (n <= kSubtrees[pass]) continue;
        const uint64_t to = 2 + pass * places;
        launch("bvh4_open", groups, {number(kSubtrees[pass]), of(lists), number(from), number(to)});
        from = to;
        groups = plan->units * kGroupsPerUnit;
    }
    const uint64_t needed = places / plan->group_items + 1;
    if (n > 1) {
        const uint64_t most = std::min(needed, plan->units * kGroupsPerUnit);
        launch("bvh4_close", groups == 1 ? 1 : most, {of(lists), number(from)});
        steps.launch("bvh4_write_leaves", most, {of(topology->nodes), of(topology->order), of(open_leaves), of(out->leaves)});
    }
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
