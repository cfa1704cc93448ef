#include "clarity_bvh/wide/wide_build.hpp"

#include "clarity_bvh/wide/wide_morton.hpp"

namespace clarity::bvh {
namespace {

constexpr float kBinaryShare = 0.85f;  // of the build time

template <uint32_t Width>
void write(const rt_host* host, const Collapse<Width>& collapse, const WideSubtrees<Width>& subtrees,
           const WideLayout<Width>& layout, const std::vector<Root>& roots, const Costs& costs, const rt_group* groups,
           const WideOutput<Width>& out, WideBuild& result) {
    WideTree<Width> wide(host, collapse, subtrees, layout, roots, costs);
    wide.write(out);
    result.nodes = wide.node_count();
    result.depth = wide.depth();
    result.stack = wide.stack();
    result.statistics = wide.statistics(groups);
}

}  // namespace

template <uint32_t Width>
WideBuild pack_wide(const rt_host* host, Topology& topology, const rt_group* groups, uint32_t group_count, const Costs& costs,
                    const WideLayout<Width>& layout, const WideOutput<Width>& out) {
    WideBuild result;
    for (uint32_t g = 0; g < group_count; ++g) result.primitives += groups[g].count;
    result.references = topology.ref_count;
    result.build_bytes = topology.nodes.count() * (sizeof(Node) + sizeof(RootCosts));
    const Scratch<RootCosts> root_costs(topology.nodes.count());
    const Collapse<Width> collapse(topology.nodes.data(), root_costs.data(), costs);
    rt::parallel_for(host, static_cast<rt_u32>(topology.parts.size()),
                     [&](rt_u32 p) { collapse.decide_part(topology.parts[p]); });
    collapse.decide_tops(topology);
    write(host, collapse, CollapsedSubtrees<Width>(collapse, layout), layout, topology.roots, costs, groups, out, result);
    return result;
}

template <uint32_t Width>
WideBuild build_wide(const rt_host* host, const rt_build_input& input, const Rules& rules, const WideLayout<Width>& layout,
                     const RefMemory& refs, const WideOutput<Width>& out) {
    WideBuild result;
    const uint64_t count = result.primitives = count_primitives(host, input);
    const Costs costs = wide_costs(rules);
    // A full wide node replaces Width - 1 binary splits, so each split costs that fraction of a node. The binary tree then ends
    // in about the leaves that the wide tree will have, and fewer nodes are built only to be merged.
    Rules binary_rules = rules;
    binary_rules.traversal_cost = costs.node / (Width - 1);
    if (rules.reinsert > 0) {
        Topology binary = build_topology(host, input, binary_rules, refs, kBinaryShare);
        result = pack_wide(host, binary, input.groups, input.group_count, costs, layout, out);
        result.build_bytes = build_bytes(binary_rules, count);
        return result;
    }
    const bool sorted = rules.method == Method::morton;
    result.build_bytes = sorted ? WideMorton<Width>::bytes(count) : TopologyBuilder::bytes(binary_rules, count);
    return with_memory_for(host, count, result.build_bytes, [&] {
        if (sorted) {
            const WideMorton<Width> tree(host, input, refs, layout, costs, count, kBinaryShare);
            result.references = count;
            write(host, tree.collapse(), tree, layout, tree.roots(), costs, input.groups, out, result);
            return result;
        }
        TopologyBuilder builder(host, input, binary_rules, count, kBinaryShare);
        static_assert(sizeof(RootCosts) == sizeof(Record), "costs take the places of records, which are not needed any more");
        const Collapse<Width> collapse(builder.nodes(), static_cast<RootCosts*>(builder.spare()), costs);
        const Topology binary = builder.run(refs, [&](const Part& part) { collapse.decide_part(part); });
        collapse.decide_tops(binary);
        rt::progress(host, (1 + kBinaryShare) / 2);
        result.references = binary.ref_count;
        write(host, collapse, CollapsedSubtrees<Width>(collapse, layout), layout, binary.roots, costs, input.groups, out,
              result);
        return result;
    });
}

void report(const rt_build_output* out, const WideBuild& build, uint64_t node_bytes) {
    const double nodes = build.nodes, bytes = static_cast<double>(node_bytes);
    rt::stat(out, "nodes", nodes);
    rt::stat(out, "leaves", static_cast<double>(build.statistics.leaves));
    rt::stat(out, "depth", build.depth);
    rt::stat(out, "references", static_cast<double>(build.references));
    rt::stat(out, "children", static_cast<double>(build.statistics.children) / nodes);
    rt::stat(out, "sah_cost", build.statistics.sah_cost);
    build.statistics.expected.report(out);
    rt::stat(out, "node_bytes", bytes);
    rt::stat(out, "bytes_per_primitive",
             build.primitives > 0 ? (bytes + static_cast<double>(build.references * sizeof(rt_packed_prim))) /
                                        static_cast<double>(build.primitives)
                                  : 0);
    rt::stat(out, "build_bytes", static_cast<double>(build.build_bytes));
}

#define CLARITY_BVH_WIDE(WIDTH)                                                                                         \
    template WideBuild pack_wide<WIDTH>(const rt_host*, Topology&, const rt_group*, uint32_t, const Costs&,             \
                                        const WideLayout<WIDTH>&, const WideOutput<WIDTH>&);                            \
    template WideBuild build_wide<WIDTH>(const rt_host*, const rt_build_input&, const Rules&, const WideLayout<WIDTH>&, \
                                         const RefMemory&, const WideOutput<WIDTH>&)
CLARITY_BVH_WIDE(4);
CLARITY_BVH_WIDE(8);

}  // namespace clarity::bvh
