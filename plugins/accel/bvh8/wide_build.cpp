#include "wide_build.hpp"

#include <cstdio>

#include "morton_tree.hpp"

namespace bvh8 {
namespace {

constexpr uint64_t kMaxPrimitives = bvh2::Builder::kMaxPrimitives;
constexpr float kBinaryShare = 0.85f;  // of the build time

}  // namespace

WideBuild build_wide(const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
    WideBuild result;
    for (uint32_t g = 0; g < input->group_count; ++g) result.primitives += input->groups[g].count;
    const uint64_t count = result.primitives;
    char why[160];
    if (count > kMaxPrimitives) {
        std::snprintf(why, sizeof why, "holds %llu primitives at most, the scene has %llu: instance meshes, or leave some out",
                      static_cast<unsigned long long>(kMaxPrimitives), static_cast<unsigned long long>(count));
        throw rt::fail(host, why);
    }
    const Costs costs{static_cast<float>(input->params[kTraversalCost]), static_cast<float>(input->params[kIntersectionCost]),
                      static_cast<uint32_t>(input->params[kMaxLeaf])};
    // A full wide node replaces BVH8_WIDTH - 1 binary splits, so each split costs that fraction of a node. The binary tree then
    // ends in about the leaves that the wide tree will have, and fewer nodes are built only to be merged.
    const bvh2::Rules rules{
        costs.max_leaf,  static_cast<uint32_t>(input->params[kBins]),        costs.node / (BVH8_WIDTH - 1),
        costs.primitive, static_cast<bvh2::Method>(input->params[kBuilder]), static_cast<float>(input->params[kDuplicates])};
    const bool sorted = rules.method == bvh2::Method::morton;
    result.build_bytes = sorted ? MortonTree::bytes(count) : bvh2::Builder::bytes(rules, count);
    const auto write = [&](const Collapse& collapse, const Subtrees& subtrees, const std::vector<bvh2::Root>& roots) {
        WideTree wide(host, collapse, subtrees, roots, costs);
        wide.write(out);
        result.nodes = wide.node_count();
        result.depth = wide.depth();
        result.stack = wide.stack();
        result.statistics = wide.statistics(input->groups);
    };
    try {
        if (sorted) {
            const MortonTree tree(host, *input, out, costs, count, kBinaryShare);
            result.references = count;
            write(tree.collapse(), tree, tree.roots());
            return result;
        }
        bvh2::Builder builder(host, *input, rules, count, kBinaryShare);
        // The root costs reuse the builder's record buffer, which is not needed any more at that time.
        static_assert(sizeof(RootCosts) == sizeof(bvh2::Record), "costs take the places of records");
        const Collapse collapse(builder.workspace().nodes, reinterpret_cast<RootCosts*>(builder.workspace().records[0]), costs);
        const bvh2::BinaryTree binary = builder.run(out, [&](const bvh2::Task& task) { collapse.decide_task(task); });
        collapse.decide_tops(binary);
        rt::progress(host, (1 + kBinaryShare) / 2);
        result.references = binary.leaf_count;
        write(collapse, CollapsedSubtrees(collapse), binary.roots);
        return result;
    } catch (const std::bad_alloc&) {
        std::snprintf(
            why, sizeof why,
            "cannot allocate the %.1f GiB that building a tree of %llu primitives takes: free memory, or instance meshes",
            static_cast<double>(result.build_bytes) / (1 << 30), static_cast<unsigned long long>(count));
        throw rt::fail(host, why);
    }
}

void report(const rt_build_output* out, const WideBuild& build, uint64_t node_bytes) {
    const double nodes = build.nodes, bytes = static_cast<double>(node_bytes);
    rt::stat(out, "nodes", nodes);
    rt::stat(out, "leaves", static_cast<double>(build.statistics.leaves));
    rt::stat(out, "depth", build.depth);
    rt::stat(out, "references", static_cast<double>(build.references));
    rt::stat(out, "children", static_cast<double>(build.statistics.children) / nodes);
    rt::stat(out, "sah_cost", build.statistics.sah_cost);
    rt::stat(out, "node_bytes", bytes);
    rt::stat(out, "bytes_per_primitive",
             build.primitives > 0 ? (bytes + static_cast<double>(build.references * sizeof(rt_packed_prim))) /
                                        static_cast<double>(build.primitives)
                                  : 0);
    rt::stat(out, "build_bytes", static_cast<double>(build.build_bytes));
}

}  // namespace bvh8
