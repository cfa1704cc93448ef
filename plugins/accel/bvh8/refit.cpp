#include "refit.hpp"

#include "clarity_bvh/parameters.hpp"
#include "clarity_bvh/refit/device_refit.hpp"
#include "clarity_bvh/refit/refit_wide.hpp"
#include "clarity_bvh/wide/wide_node.hpp"

namespace bvh8 {
namespace {

using namespace clarity::bvh;

struct Rows {
    static constexpr uint32_t kWidth = 8, kBlock = 64;
    WideNode<8>* nodes;
    float* plane(uint32_t at, uint32_t k) const { return nodes[at].plane[k]; }
    uint32_t child(uint32_t at, uint32_t slot) const { return nodes[at].child[slot]; }
};

}  // namespace

int32_t refit(const rt_host* host, const rt_refit_input* in, const rt_refit_output* out) {
    WideRefit<Rows> layout({static_cast<WideNode<8>*>(out->slots[0])}, in->slot_counts[0], in);
    const Rules rules = wide_rules(in->params);
    Refit<WideRefit<Rows>>(host, in, out, layout, {rules.traversal_cost, rules.intersection_cost}).run();
    return RT_OK;
}

int32_t device_ranges(const rt_host* host, const rt_built* built, rt_u32 group, rt_tree_ranges* out) {
    const auto* const nodes = static_cast<const WideNode<8>*>(built->slots[0]);
    return find_ranges(
        host, built, group, out, [&](uint32_t at) -> const auto& { return nodes[at].child; });
}

int32_t device_refit(const rt_host*, const rt_device_plan* plan, const rt_device_tree* tree, rt_u32 blocks, rt_u32 costs,
                     const double* params) {
    const Rules rules = wide_rules(params);
    return plan_refit(plan, "bvh8_refit", tree, blocks, costs, {rules.traversal_cost, rules.intersection_cost});
}

}  // namespace bvh8
