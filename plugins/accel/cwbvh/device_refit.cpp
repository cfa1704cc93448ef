#include "device_refit.hpp"

#include <array>

#include "clarity_bvh/parameters.hpp"
#include "clarity_bvh/refit/device_refit.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "cwbvh_types.h"

namespace cwbvh {
namespace {

using namespace clarity::bvh;

// The children of a node as codes of topology.hpp.
std::array<uint32_t, 8> codes_of(const cwbvh_node& node) {
    std::array<uint32_t, 8> codes;
    uint32_t child = node.first_child, first = node.first_leaf;
    for (uint32_t slot = 0; slot < 8; ++slot) {
        uint32_t count = 0;
        for (uint32_t bits = node.primitives >> 4 * slot & 15u; bits != 0; bits >>= 1) ++count;
        const bool inner = CWBVH_INNER(&node) >> slot & 1u;
        codes[slot] = inner ? child++ : count > 0 ? make_leaf(first, count) : kEmpty;
        first += count;
    }
    return codes;
}

}  // namespace

int32_t device_ranges(const rt_host* host, const rt_built* built, rt_u32 group, rt_tree_ranges* out) {
    const auto* const nodes = static_cast<const cwbvh_node*>(built->slots[0]);
    return find_ranges(host, built, group, out, [&](uint32_t at) { return codes_of(nodes[at]); });
}

int32_t device_refit(const rt_host*, const rt_device_plan* plan, const rt_device_tree* tree, rt_u32 blocks, rt_u32 costs,
                     const double* params) {
    const Rules rules = wide_rules(params);
    return plan_refit(plan, "cwbvh_refit", tree, blocks, costs, {rules.traversal_cost, rules.intersection_cost});
}

}  // namespace cwbvh
