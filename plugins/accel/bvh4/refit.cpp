#include "refit.hpp"

#include <cstring>

#include "clarity_bvh/parameters.hpp"
#include "clarity_bvh/refit/refit_wide.hpp"
#include "clarity_bvh/wide/wide_node.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh4_types.h"

namespace bvh4 {
namespace {

// Rows stand where settle() has put them, and children are the addresses that it made.
struct Rows {
    static constexpr uint32_t kWidth = 4, kBlock = 128;
    float* nodes;
    float* plane(uint32_t at, uint32_t k) const { return row(at, k); }
    uint32_t child(uint32_t at, uint32_t slot) const {
        uint32_t code;
        std::memcpy(&code, row(at, 6) + slot, sizeof code);
        return clarity::bvh::is_leaf(code) ? code : BVH4_INDEX(code);
    }

 private:
    float* row(uint32_t at, uint32_t k) const { return nodes + 32 * uint64_t{at} + 4 * (k ^ (at & 7u)); }
};
static_assert(sizeof(bvh4_node) == 32 * sizeof(float), "eight rows of four numbers");

}  // namespace

int32_t refit(const rt_host* host, const rt_refit_input* in, const rt_refit_output* out) {
    using namespace clarity::bvh;
    WideRefit<Rows> layout({static_cast<float*>(out->slots[0])}, in->slot_counts[0], in);
    const Rules rules = wide_rules(in->params);
    Refit<WideRefit<Rows>>(host, in, out, layout, {rules.traversal_cost, rules.intersection_cost}).run();
    return RT_OK;
}

}  // namespace bvh4
