#include "refit.hpp"

#include "clarity_bvh/parameters.hpp"
#include "clarity_bvh/refit/refit_wide.hpp"
#include "clarity_bvh/wide/wide_node.hpp"

namespace bvh8 {
namespace {

struct Rows {
    static constexpr uint32_t kWidth = 8, kBlock = 64;
    clarity::bvh::WideNode<8>* nodes;
    float* plane(uint32_t at, uint32_t k) const { return nodes[at].plane[k]; }
    uint32_t child(uint32_t at, uint32_t slot) const { return nodes[at].child[slot]; }
};

}  // namespace

int32_t refit(const rt_host* host, const rt_refit_input* in, const rt_refit_output* out) {
    using namespace clarity::bvh;
    WideRefit<Rows> layout({static_cast<WideNode<8>*>(out->slots[0])}, in->slot_counts[0], in);
    const Rules rules = wide_rules(in->params);
    Refit<WideRefit<Rows>>(host, in, out, layout, {rules.traversal_cost, rules.intersection_cost}).run();
    return RT_OK;
}

}  // namespace bvh8
