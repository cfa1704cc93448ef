// bvh2.cpp -- the plugin of the binary BVH (binned surface area heuristic, SAH): its table and its build entry.
//
// Source: Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies". A node takes 64 bytes. n primitives make
// at most n - 1 nodes. The build measures the depth of the tree and defines the stack size of the traversal (BVH2_STACK) from
// it. The structure suits static scenes. It is weak where large and small primitives overlap; there builder=spatial helps.
#include <algorithm>
#include <cstdio>
#include <string>

#include "levels.hpp"
#include "pack.hpp"
#include "rt_plugin.hpp"
#include "statistics.hpp"
#include "write_nodes.hpp"

namespace bvh2 {
namespace {

enum Param { kMaxLeaf, kBins, kTraversalCost, kIntersectionCost, kSplit, kBuilder, kDuplicates };
constexpr const char* kSplits[] = {"sah", "median", nullptr};
constexpr const char* kBuilders[] = {"sah", "morton", "spatial", nullptr};
constexpr rt_param kParams[] = {
    rt::int_param("max_leaf", "Max leaf size", "primitives in a leaf, at most; fewer where the heuristic finds that cheaper", 1,
                  BVH2_LEAF_MAX, 4),
    rt::int_param("bins", "Bins", "slices per axis in which split planes are sought; more: slower to build, slightly better", 2,
                  kMaxBins, 32),
    rt::float_param("traversal_cost", "Traversal cost", "what a node costs a ray, in the unit of the intersection cost", 0.01,
                    100, 1),
    rt::float_param("intersection_cost", "Intersection cost", "what a primitive costs a ray, in the unit of the traversal cost",
                    0.01, 100, 1),
    rt::enum_param("split", "Split", "where nodes are parted: by the surface area heuristic, or into even halves by count",
                   kSplits, 0),
    rt::enum_param("builder", "Builder",
                   "sah: binned surface area heuristic; morton: along a space-filling curve, several times faster to build and "
                   "slower to trace; spatial: heuristic that cuts triangles too, slow to build, for large ones among small",
                   kBuilders, 0),
    rt::float_param("duplicates", "Duplicates", "what builder=spatial may add to the primitives, as a share of their number", 0,
                    4, 0.3),
};

Rules rules_of(const double* params) {
    return {static_cast<uint32_t>(params[kMaxLeaf]),
            static_cast<uint32_t>(params[kBins]),
            static_cast<float>(params[kTraversalCost]),
            static_cast<float>(params[kIntersectionCost]),
            static_cast<Method>(params[kBuilder]),
            static_cast<float>(params[kDuplicates]),
            params[kSplit] == 1};
}

// The traversal needs one stack entry a level, and one more to tell a full stack from an overflow. The size is a multiple of 8,
// because a new value recompiles the kernels.
void define_stack(const rt_build_output* out, uint32_t depth) {
    rt::define(out, "BVH2_STACK", (depth + 1 + 7) / 8 * 8);
}

int32_t build(const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
    uint64_t count = 0;
    for (uint32_t g = 0; g < input->group_count; ++g) count += input->groups[g].count;
    char why[160];
    if (count > Builder::kMaxPrimitives) {
        std::snprintf(why, sizeof why, "holds %llu primitives at most, the scene has %llu: instance meshes, or leave some out",
                      static_cast<unsigned long long>(Builder::kMaxPrimitives), static_cast<unsigned long long>(count));
        throw rt::fail(host, why);
    }
    const Rules rules = rules_of(input->params);
    try {
        Builder builder(host, *input, rules, count, 1.0f);
        const BinaryTree tree = builder.run(out, [](const Task&) {});
        const Written written = write_nodes(host, tree, out);
        const Statistics statistics = measure(host, rules, written.nodes, written.count, written.roots, input->groups);
        rt::stat(out, "nodes", written.count);
        rt::stat(out, "leaves", static_cast<double>(statistics.leaves));
        rt::stat(out, "depth", tree.depth);
        rt::stat(out, "references", static_cast<double>(tree.leaf_count));
        rt::stat(out, "sah_cost", statistics.sah_cost);
        rt::stat(out, "build_bytes", static_cast<double>(Builder::bytes(rules, count)));
        define_stack(out, tree.depth);
        return RT_OK;
    } catch (const std::bad_alloc&) {
        std::snprintf(
            why, sizeof why,
            "cannot allocate the %.1f GiB that building a tree of %llu primitives takes: free memory, or instance meshes",
            static_cast<double>(Builder::bytes(rules, count)) / (1 << 30), static_cast<unsigned long long>(count));
        throw rt::fail(host, why);
    }
}

// Packs the tree of another plugin. Refs keep their order, so leaves are the topology's, or parts of them.
int32_t pack(const rt_host* host, const rt_build_input* input, const rt_topology* topology, const rt_build_output* out) {
    if (topology->ref_count > Builder::kMaxPrimitives)
        throw rt::fail(host, "holds 2^28 - 1 refs at most, the topology has " + std::to_string(topology->ref_count));
    const Packed packed = pack_topology(host, *topology);
    if (packed.nodes.size() >= BVH2_LEAF)
        throw rt::fail(host, "holds 2^31 - 1 nodes at most, the topology needs " + std::to_string(packed.nodes.size()));
    auto* const nodes = rt::alloc<bvh2_node>(out, 0, packed.nodes.size());
    std::copy(packed.nodes.begin(), packed.nodes.end(), nodes);
    std::copy_n(topology->refs, topology->ref_count, rt::leaves(out, topology->ref_count));
    for (rt_u32 g = 0; g < topology->group_count; ++g) rt::root(out, g, packed.roots[g]);
    const Statistics statistics =
        measure(host, rules_of(input->params), nodes, static_cast<rt_u32>(packed.nodes.size()), packed.roots, input->groups);
    rt::stat(out, "nodes", static_cast<double>(packed.nodes.size()));
    rt::stat(out, "leaves", static_cast<double>(statistics.leaves));
    rt::stat(out, "depth", packed.depth);
    rt::stat(out, "references", static_cast<double>(topology->ref_count));
    rt::stat(out, "sah_cost", statistics.sah_cost);
    define_stack(out, packed.depth);
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "bvh2.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<bvh2_node>("bvh2_nodes", "bvh2_node")};
constexpr rt_accel kAccel = rt::accel(kSlots, rt::file(kFiles, "bvh2_types.h"), rt::file(kFiles, "bvh2.cl"), rt::guarded<build>,
                                      rt::guarded<levels>, rt::Traits().merit(1, 1), rt::guarded<pack>);
static_assert(sizeof(bvh2_node) == 64, "a node is a cache line");
static_assert(kAccel.types.text && kAccel.traverse.text, "the kernel files are embedded");

}  // namespace
}  // namespace bvh2

const rt_plugin rt_plugin_v1 =
    rt::accel_plugin("bvh2", "Binary BVH (binned SAH)", "1.0.0",
                     "Wald 2007, On fast Construction of SAH-based Bounding Volume Hierarchies", bvh2::kParams, bvh2::kAccel);
