// wide_build.hpp -- one build of a wide tree, from the parameters to the statistics. Shared by bvh8, bvh4 and cwbvh.
#pragma once
#include "rt_plugin.hpp"
#include "wide_tree.hpp"

namespace bvh8 {

// The shared parameters, in the order in which a plugin must declare them. A plugin may append its own.
enum Param { kMaxLeaf, kBins, kTraversalCost, kIntersectionCost, kBuilder, kDuplicates, kOwnParams };

constexpr const char* kBuilders[] = {"sah", "morton", "spatial", nullptr};

constexpr rt_param max_leaf_param(int most, int usual) {
    return rt::int_param("max_leaf", "Max leaf size",
                         "primitives in a leaf, at most; fewer where the heuristic finds that cheaper", 1, most, usual);
}
constexpr rt_param kBinsParam =
    rt::int_param("bins", "Bins", "slices per axis in which split planes are sought; more: slower to build, slightly better", 2,
                  bvh2::kMaxBins, 32);
constexpr rt_param kTraversalParam = rt::float_param(
    "traversal_cost", "Traversal cost", "what a node costs a ray, in the unit of the intersection cost", 0.01, 100, 3);
constexpr rt_param intersection_param(double usual) {
    return rt::float_param("intersection_cost", "Intersection cost",
                           "what a primitive costs a ray, in the unit of the traversal cost", 0.01, 100, usual);
}
constexpr rt_param kBuilderParam =
    rt::enum_param("builder", "Builder",
                   "sah: binned surface area heuristic; morton: along a space-filling curve, several times faster to build and "
                   "slower to trace; spatial: heuristic that cuts triangles too, slow to build, for large ones among small",
                   kBuilders, 0);
constexpr rt_param kDuplicatesParam = rt::float_param(
    "duplicates", "Duplicates", "what builder=spatial may add to the primitives, as a share of their number", 0, 4, 0.3);

// The results of a build.
struct WideBuild {
    uint64_t primitives = 0, references = 0, build_bytes = 0;
    rt_u32 nodes = 0;
    uint32_t depth = 0, stack = 0;  // see WideTree
    Statistics statistics;
};

// Builds the tree: fills slot 0 with bvh8_nodes, writes the leaf order and reports the roots. Throws if there are too many
// primitives, if the user cancels, or if memory is short.
WideBuild build_wide(const rt_host* host, const rt_build_input* input, const rt_build_output* out);

// Reports the statistics that all wide trees have. `node_bytes` is the size of all nodes in bytes.
void report(const rt_build_output* out, const WideBuild& build, uint64_t node_bytes);

// Returns the size of the traversal's stack: the children that may be deferred, and one more entry to tell a full stack from an
// overflow. It is a multiple of 16, because a new value recompiles the kernels. It is not a multiple of 64: data at distances
// of whole pages evict each other from the first-level cache (the entry distances of a packet would span exactly one page;
// legocar's camera rays then took 1.4 times as long).
constexpr rt_u32 stack_places(uint32_t put_off) {
    const rt_u32 places = (put_off + 1 + 15) / 16 * 16;
    return places % 64 == 0 ? places + 16 : places;
}

}  // namespace bvh8
