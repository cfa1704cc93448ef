#include "device_refit.hpp"

#include <array>

#include "clarity_bvh/parameters.hpp"
#include "clarity_bvh/refit/device_refit.hpp"
#include "clarity_bvh/wide/wide_node.hpp"

namespace bvh8 {

int32_t device_ranges(const rt_host* host, const rt_built* built, rt_u32 group, rt_tree_ranges* out) {
    const auto* const nodes = static_cast<const clarity::bvh::WideNode<8>*>(built->slots[0]);
    return clarity::bvh::find_ranges(
        host, built, group, out, [&](uint32_t at) -> const auto& { return nodes[at].child; });
}

int32_t device_refit(const rt_host*, const rt_device_plan* plan, const rt_device_tree* tree, rt_u32 blocks, rt_u32 costs,
                     const double* params) {
    const clarity::bvh::Rules rules = clarity::bvh::wide_rules(params);
    return clarity::bvh::plan_refit(plan, "bvh8_refit", tree, blocks, costs, {rules.traversal_cost, rules.intersection_cost});
}

}  // namespace bvh8
