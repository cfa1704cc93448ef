#include "pack.hpp"

#include <algorithm>

#include "clarity_bvh/wide/octant_slots.hpp"
#include "clarity_bvh/wide/wide_build.hpp"
#include "incoherent.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh8_types.h"

namespace bvh8 {
namespace {

using namespace clarity::bvh;

constexpr WideLayout<8> kLayout{write_octant_node, nullptr};
static_assert(BVH8_EMPTY == kEmpty && BVH8_MAKE_LEAF(5u, 3u) == make_leaf(5, 3), "the library's codes of children");

void finish(const rt_build_input& input, const WideBuild& wide, const rt_build_output* out) {
    report(out, wide, uint64_t{wide.nodes} * sizeof(bvh8_node));
    rt::define(out, "BVH8_STACK", stack_places(wide.stack));
    const auto incoherent = static_cast<Incoherent>(input.params[kIncoherent]);
    rt::define(out, "BVH8_SINGLE", incoherent == kSingle || (incoherent == kAuto && wide.primitives > kTogether));
}

}  // namespace

void pack(const rt_host* host, const rt_build_input& input, Topology& topology, const rt_u32* refs,
          const rt_build_output* out) {
    std::copy_n(refs, topology.ref_count, rt::leaves(out, topology.ref_count));
    finish(input,
           pack_wide(host, topology, input.groups, input.group_count, wide_costs(wide_rules(input.params)), kLayout,
                     host_nodes<bvh8_node, 8>(out)),
           out);
}

int32_t build(const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
    finish(*input, build_wide(host, *input, wide_rules(input->params), kLayout, host_refs(out), host_nodes<bvh8_node, 8>(out)),
           out);
    return RT_OK;
}

}  // namespace bvh8
