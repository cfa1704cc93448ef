// wide_build.hpp -- wide trees, from the host's primitives or from any topology, to nodes in memory and their statistics.
#pragma once
#include "clarity_bvh/build/builder.hpp"
#include "clarity_bvh/wide/wide_tree.hpp"
#include "rt_plugin.hpp"

namespace clarity::bvh {

// The results of a build.
struct WideBuild {
    uint64_t primitives = 0, references = 0, build_bytes = 0;
    uint32_t nodes = 0;
    uint32_t depth = 0, stack = 0;  // see WideTree
    WideStatistics statistics;
};

// Collapses a topology and writes the wide nodes, on all cores. The leaf order stays that of the topology. Uses the words work0
// and work1 of its nodes. `groups` are those of the build's input. Leaves are taken as they are, or joined to larger ones where
// that is cheaper, up to costs.max_leaf (at most kLeafMax). Sets build_bytes to the memory that packing takes. Throws
// std::bad_alloc, or rt::Cancelled.
template <uint32_t Width>
WideBuild pack_wide(const rt_host* host, Topology& topology, const rt_group* groups, uint32_t group_count, const Costs& costs,
                    const WideLayout<Width>& layout, const WideOutput<Width>& out);

// Builds a tree by the rules, and packs it part by part while the caches hold it. rules.traversal_cost is that of a wide node.
// Throws rt::Stopped, with the host told why, if there are too many primitives or if memory is short; rt::Cancelled if the user
// cancels.
template <uint32_t Width>
WideBuild build_wide(const rt_host* host, const rt_build_input& input, const Rules& rules, const WideLayout<Width>& layout,
                     const RefMemory& refs, const WideOutput<Width>& out);

// Writes to the host: the refs to its leaf order, the nodes to slot 0. T is the plugin's own struct of the same layout as
// WideNode<Width>.
inline RefMemory host_refs(const rt_build_output* out) {
    return [out](uint64_t count) { return rt::leaves(out, count); };
}
template <class T, uint32_t Width>
WideOutput<Width> host_nodes(const rt_build_output* out) {
    static_assert(sizeof(T) == sizeof(WideNode<Width>), "the same layout");
    return {[out](uint64_t count) { return reinterpret_cast<WideNode<Width>*>(rt::alloc<T>(out, 0, count)); },
            [out](uint32_t group, uint32_t node) { rt::root(out, group, node); }};
}

// Reports the statistics that all wide trees have. `node_bytes` is the size of all nodes in bytes.
void report(const rt_build_output* out, const WideBuild& build, uint64_t node_bytes);

// Returns the size of the traversal's stack: the children that may be deferred, and one more entry to tell a full stack from an
// overflow. It is a multiple of 16, because a new value recompiles the kernels. It is not a multiple of 64: data at distances
// of whole pages evict each other from the first-level cache (the entry distances of a packet would span exactly one page;
// legocar's camera rays then took 1.4 times as long).
constexpr uint32_t stack_places(uint32_t put_off) {
    const uint32_t places = (put_off + 1 + 15) / 16 * 16;
    return places % 64 == 0 ? places + 16 : places;
}

#define CLARITY_BVH_WIDE(WIDTH)                                                                                                \
    extern template WideBuild pack_wide<WIDTH>(const rt_host*, Topology&, const rt_group*, uint32_t, const Costs&,             \
                                               const WideLayout<WIDTH>&, const WideOutput<WIDTH>&);                            \
    extern template WideBuild build_wide<WIDTH>(const rt_host*, const rt_build_input&, const Rules&, const WideLayout<WIDTH>&, \
                                                const RefMemory&, const WideOutput<WIDTH>&)
CLARITY_BVH_WIDE(4);
CLARITY_BVH_WIDE(8);
#undef CLARITY_BVH_WIDE

}  // namespace clarity::bvh
