#include "pack.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "clarity_bvh/build/builder.hpp"
#include "clarity_bvh/pack_binary.hpp"
#include "parameters.hpp"
#include "statistics.hpp"

namespace bvh2 {
namespace {

using namespace clarity::bvh;

static_assert(BVH2_MAKE_LEAF(0u, 0u) == kEmpty && BVH2_MAKE_LEAF(5u, 3u) == make_leaf(5, 3) && BVH2_LEAF_MAX == kLeafMax,
              "the library's codes of children");

// The layouts are the same, so a node is copied whole.
static_assert(sizeof(bvh2_node) == sizeof(Node) && offsetof(bvh2_node, child0) == offsetof(Node, child0) &&
                  offsetof(bvh2_node, box1) == offsetof(Node, box1) && offsetof(bvh2_node, child1) == offsetof(Node, child1),
              "a bvh2_node is a Node");
void convert(bvh2_node& to, const Node& from) {
    std::memcpy(&to, &from, sizeof to);
    to.pad0 = to.pad1 = 0;
}

// Writes slot 0, the roots, the defines and the statistics. The leaf order is written already.
void write(const rt_host* host, const rt_build_input& input, const Topology& topology, uint64_t build_bytes,
           const rt_build_output* out) {
    const bvh2_node* nodes = nullptr;
    rt_u32 count = 0;
    const std::vector<rt_u32> roots = pack_binary(
        host, topology,
        [&](uint32_t node_count) {
            count = node_count;
            bvh2_node* const memory = rt::alloc<bvh2_node>(out, 0, node_count);
            nodes = memory;
            return memory;
        },
        convert);
    for (rt_u32 g = 0; g < roots.size(); ++g) rt::root(out, g, roots[g]);
    const Statistics statistics = measure(host, rules_of(input.params), nodes, count, roots, input.groups);
    rt::stat(out, "nodes", count);
    rt::stat(out, "leaves", static_cast<double>(statistics.leaves));
    rt::stat(out, "depth", topology.depth);
    rt::stat(out, "references", static_cast<double>(topology.ref_count));
    rt::stat(out, "sah_cost", statistics.sah_cost);
    rt::stat(out, "build_bytes", static_cast<double>(build_bytes));
    // The traversal needs one stack entry a level, and one more to tell a full stack from an overflow. The size is a multiple
    // of 8, because a new value recompiles the kernels.
    rt::define(out, "BVH2_STACK", (topology.depth + 1 + 7) / 8 * 8);
}

}  // namespace

void pack(const rt_host* host, const rt_build_input& input, Topology& topology, const rt_u32* refs,
          const rt_build_output* out) {
    std::copy_n(refs, topology.ref_count, rt::leaves(out, topology.ref_count));
    write(host, input, topology, topology.nodes.count() * sizeof(Node), out);
}

int32_t build(const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
    const uint64_t count = count_primitives(host, *input);
    const Rules rules = rules_of(input->params);
    const uint64_t bytes = TopologyBuilder::bytes(rules, count);
    with_memory_for(host, count, bytes, [&] {
        TopologyBuilder builder(host, *input, rules, count, 1.0f);
        const Topology topology = builder.run([out](uint64_t refs) { return rt::leaves(out, refs); }, [](const Part&) {});
        write(host, *input, topology, bytes, out);
    });
    return RT_OK;
}

}  // namespace bvh2
