#include "refit.hpp"

#include "clarity_bvh/refit/refit_binary.hpp"
#include "parameters.hpp"

namespace bvh2 {

int32_t refit(const rt_host* host, const rt_refit_input* in, const rt_refit_output* out) {
    using namespace clarity::bvh;
    // pack.cpp asserts that a bvh2_node is a Node.
    BinaryRefit layout(static_cast<Node*>(out->slots[0]), in->slot_counts[0], in);
    const Rules rules = rules_of(in->params);
    Refit<BinaryRefit>(host, in, out, layout, {rules.traversal_cost, rules.intersection_cost}).run();
    return RT_OK;
}

}  // namespace bvh2
