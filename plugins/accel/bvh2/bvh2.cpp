// bvh2.cpp -- the plugin of the binary BVH (binned surface area heuristic, SAH): its table and its build entry.
//
// Source: Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies". A node takes 64 bytes. n primitives make
// at most n - 1 nodes. The build measures the depth of the tree and defines the stack size of the traversal (BVH2_STACK) from
// it. The structure suits static scenes. It is weak where large and small primitives overlap; there builder=spatial helps.
#include <cstdio>

#include "levels.hpp"
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

int32_t build(const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
    uint64_t count = 0;
    for (uint32_t g = 0; g < input->group_count; ++g) count += input->groups[g].count;
    char why[160];
    if (count > Builder::kMaxPrimitives) {
        std::snprintf(why, sizeof why, "holds %llu primitives at most, the scene has %llu: instance meshes, or leave some out",
                      static_cast<unsigned long long>(Builder::kMaxPrimitives), static_cast<unsigned long long>(count));
        throw rt::fail(host, why);
    }
    const Rules rules{static_cast<uint32_t>(input->params[kMaxLeaf]),
                      static_cast<uint32_t>(input->params[kBins]),
                      static_cast<float>(input->params[kTraversalCost]),
                      static_cast<float>(input->params[kIntersectionCost]),
                      static_cast<Method>(input->params[kBuilder]),
                      static_cast<float>(input->params[kDuplicates]),
                      input->params[kSplit] == 1};
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
        // The traversal needs one stack entry a level, and one more to tell a full stack from an overflow. The size is a
        // multiple of 8, because a new value recompiles the kernels.
        rt::define(out, "BVH2_STACK", (tree.depth + 1 + 7) / 8 * 8);
        return RT_OK;
    } catch (const std::bad_alloc&) {
        std::snprintf(
            why, sizeof why,
            "cannot allocate the %.1f GiB that building a tree of %llu primitives takes: free memory, or instance meshes",
            static_cast<double>(Builder::bytes(rules, count)) / (1 << 30), static_cast<unsigned long long>(count));
        throw rt::fail(host, why);
    }
}

constexpr rt_cl_file kFiles[] = {
#include "bvh2.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<bvh2_node>("bvh2_nodes", "bvh2_node")};
constexpr rt_accel kAccel = rt::accel(kSlots, rt::file(kFiles, "bvh2_types.h"), rt::file(kFiles, "bvh2.cl"), rt::guarded<build>,
                                      rt::guarded<levels>, rt::Traits().merit(1, 1));
static_assert(sizeof(bvh2_node) == 64, "a node is a cache line");
static_assert(kAccel.types.text && kAccel.traverse.text, "the kernel files are embedded");

}  // namespace
}  // namespace bvh2

const rt_plugin rt_plugin_v1 =
    rt::accel_plugin("bvh2", "Binary BVH (binned SAH)", "1.0.0",
                     "Wald 2007, On fast Construction of SAH-based Bounding Volume Hierarchies", bvh2::kParams, bvh2::kAccel);
