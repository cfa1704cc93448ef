#include "pack.hpp"

#include <algorithm>

#include "clarity_bvh/parameters.hpp"
#include "clarity_bvh/wide/wide_build.hpp"
#include "node_memory.hpp"
#include "node_slots.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh4_types.h"

namespace bvh4 {
namespace {

using namespace clarity::bvh;

constexpr WideLayout<4> kLayout{write_node, settle};
static_assert(BVH4_EMPTY == kEmpty && BVH4_MAKE_LEAF(5u, 3u) == make_leaf(5, 3), "the library's codes of children");

void finish(const WideBuild& wide, const rt_build_output* out) {
    report(out, wide, uint64_t{wide.nodes} * sizeof(bvh4_node));
    rt::define(out, "BVH4_STACK", stack_places(wide.stack));
}

}  // namespace

void pack(const rt_host* host, const rt_build_input& input, Topology& topology, const rt_u32* refs,
          const rt_build_output* out) {
    std::copy_n(refs, topology.ref_count, rt::leaves(out, topology.ref_count));
    finish(pack_wide(host, topology, input.groups, input.group_count, wide_costs(wide_rules(input.params)), kLayout,
                     host_nodes<bvh4_node, 4>(out)),
           out);
}

int32_t build(const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
    finish(build_wide(host, *input, wide_rules(input->params), kLayout, host_refs(out), host_nodes<bvh4_node, 4>(out)), out);
    return RT_OK;
}

}  // namespace bvh4
