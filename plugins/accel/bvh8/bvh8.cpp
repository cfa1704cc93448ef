// bvh8.cpp -- bounding volume hierarchy of eight children a node, the usual structure on a CPU: the plugin's table, and its
// entry.
//
// Binary tree by bvh2's builder, its nodes merged by the surface area heuristic, 224 bytes a node, 58 to 60 a triangle with the
// triangle itself. Packets that keep together are tested by their bounds against all children at once, and so is a single ray;
// the tree is shallow. A tree of a few nodes is traced faster as bvh2, whose packets need no bounds.
#include <cstdio>

#include "rt_plugin.hpp"
#include "wide_levels.hpp"
#include "wide_tree.hpp"

namespace bvh8 {
namespace {

// bvh4 is this plugin once more, of another width: its folder says what differs.
#if BVH8_WIDTH == 4
#include "bvh4_table.inl"
#else
constexpr rt_cl_file kFiles[] = {
#include "bvh8.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<bvh8_node>("bvh8_nodes", "bvh8_node")};
static_assert(sizeof(bvh8_node) == 224, "rows are aligned vectors");
constexpr const char *kId = "bvh8", *kName = "8-wide BVH (binned SAH, collapsed)", *kStack = "BVH8_STACK";
constexpr rt_cl_file kTypes = rt::file(kFiles, "bvh8_types.h"), kTraversal = rt::file(kFiles, "bvh8.cl");

// How a CPU traces packets whose rays part.
enum Incoherent { kAuto, kPackets, kSingle };
constexpr const char* kIncoherentWays[] = {"auto", "packets", "single", nullptr};
// Measured with diffuse rays on a CPU of 1 MiB L2 (docs/performance.md): of nine scenes the three of 2 000 to 11 000 triangles
// and one of 70 000 are traced faster together, those of 50 000, 87 000, 100 000 and a million alone, the largest 1.4 times as
// fast.
constexpr uint64_t kTogether = 40'000;  // primitives
// Leaves of the kernels' own measure: four triangles are tested by one ray at the price of one, and a packet's bounds spare it
// most leaves. Against leaves of four at a cost of 1, measured over the twelve views of the suite `cpu`: diffuse rays 1.05
// times as fast, shadow rays 1.07, primary rays 1.03, nodes a third fewer.
constexpr int kLeafSize = BVH8_LEAF_MAX;
constexpr double kLeafCost = 0.4;
#endif

// Room for what is put off, and one to spare that tells a full stack from an overflowing one; in steps of 16, since a new value
// recompiles the kernels. Not 64: what stands at multiples of a page from each other drives itself out of the first cache
// (a packet's entry distances would be one page; legocar's camera rays took 1.4 times as long).
uint32_t stack_places(uint32_t put_off) {
    const uint32_t places = (put_off + 1 + 15) / 16 * 16;
    return places % 64 == 0 ? places + 16 : places;
}

enum Param { kMaxLeaf, kBins, kTraversalCost, kIntersectionCost, kBuilder, kDuplicates, kIncoherent };
constexpr const char* kBuilders[] = {"sah", "morton", "spatial", nullptr};
constexpr rt_param kParams[] = {
    rt::int_param("max_leaf", "Max leaf size", "primitives in a leaf, at most; fewer where the heuristic finds that cheaper", 1,
                  BVH8_LEAF_MAX, kLeafSize),
    rt::int_param("bins", "Bins", "slices per axis in which split planes are sought; more: slower to build, slightly better", 2,
                  bvh2::kMaxBins, 32),
    rt::float_param("traversal_cost", "Traversal cost", "what a node costs a ray, in the unit of the intersection cost", 0.01,
                    100, 3),
    rt::float_param("intersection_cost", "Intersection cost", "what a primitive costs a ray, in the unit of the traversal cost",
                    0.01, 100, kLeafCost),
    rt::enum_param("builder", "Builder",
                   "sah: binned surface area heuristic; morton: along a space-filling curve, several times faster to build and "
                   "slower to trace; spatial: heuristic that cuts triangles too, slow to build, for large ones among small",
                   kBuilders, 0),
    rt::float_param("duplicates", "Duplicates", "what builder=spatial may add to the primitives, as a share of their number", 0,
                    4, 0.3),
#if BVH8_WIDTH == 8
    rt::enum_param(
        "incoherent", "Incoherent rays",
        "how a CPU traces packets whose rays part: packets: together; single: each alone; auto: alone where the tree "
        "is larger than its caches",
        kIncoherentWays, kAuto),
#endif
};

constexpr uint64_t kMaxPrimitives = bvh2::Builder::kMaxPrimitives;
constexpr float kBinaryShare = 0.85f;  // of the time

int32_t build(const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
    uint64_t count = 0;
    for (uint32_t g = 0; g < input->group_count; ++g) count += input->groups[g].count;
    char why[160];
    if (count > kMaxPrimitives) {
        std::snprintf(why, sizeof why, "holds %llu primitives at most, the scene has %llu: instance meshes, or leave some out",
                      static_cast<unsigned long long>(kMaxPrimitives), static_cast<unsigned long long>(count));
        throw rt::fail(host, why);
    }
    const Costs costs{static_cast<float>(input->params[kTraversalCost]), static_cast<float>(input->params[kIntersectionCost]),
                      static_cast<uint32_t>(input->params[kMaxLeaf])};
    // Of the splits behind a full node each costs its part: the binary tree then ends in about the leaves that the wide
    // one will have, and less is built that is merged again.
    const bvh2::Rules rules{
        costs.max_leaf,  static_cast<uint32_t>(input->params[kBins]),        costs.node / (BVH8_WIDTH - 1),
        costs.primitive, static_cast<bvh2::Method>(input->params[kBuilder]), static_cast<float>(input->params[kDuplicates])};
    try {
        bvh2::Builder builder(host, *input, rules, count, kBinaryShare);
        const Collapse collapse(builder, costs);
        const bvh2::BinaryTree binary = builder.run(out, [&](const bvh2::Task& task) { collapse.decide_task(task); });
        collapse.decide_tops(binary);
        rt::progress(host, (1 + kBinaryShare) / 2);
        WideTree wide(host, collapse, binary, costs);
        wide.write(out);
        const Statistics statistics = wide.statistics(input->groups);
        const double nodes = wide.node_count(), bytes = nodes * sizeof(bvh8_node);
        rt::stat(out, "nodes", nodes);
        rt::stat(out, "leaves", static_cast<double>(statistics.leaves));
        rt::stat(out, "depth", wide.depth());
        rt::stat(out, "references", static_cast<double>(binary.leaf_count));
        rt::stat(out, "children", static_cast<double>(statistics.children) / nodes);
        rt::stat(out, "sah_cost", statistics.sah_cost);
        rt::stat(out, "node_bytes", bytes);
        rt::stat(
            out, "bytes_per_primitive",
            count > 0 ? (bytes + static_cast<double>(binary.leaf_count * sizeof(rt_leaf))) / static_cast<double>(count) : 0);
        rt::stat(out, "build_bytes", static_cast<double>(bvh2::Builder::bytes(rules, count)));
        rt::define(out, kStack, stack_places(wide.stack()));
#if BVH8_WIDTH == 8
        const auto incoherent = static_cast<Incoherent>(input->params[kIncoherent]);
        rt::define(out, "BVH8_SINGLE", incoherent == kSingle || (incoherent == kAuto && count > kTogether));
#endif
        return RT_OK;
    } catch (const std::bad_alloc&) {
        std::snprintf(why, sizeof why, "could not get the %.1f GiB that building a tree of %llu primitives takes",
                      static_cast<double>(bvh2::Builder::bytes(rules, count)) / (1 << 30),
                      static_cast<unsigned long long>(count));
        throw rt::fail(host, why);
    }
}

constexpr rt_accel kAccel = {sizeof(rt_accel), 1, kSlots, kTypes, kTraversal, rt::guarded<build>, rt::guarded<levels>, nullptr};
static_assert(kAccel.types.text && kAccel.traverse.text, "the kernel files are embedded");

}  // namespace
}  // namespace bvh8

const rt_plugin rt_plugin_v1 = rt::accel_plugin(bvh8::kId, bvh8::kName, "1.0.0",
                                                "Wald, Benthin, Boulos 2008, Getting Rid of Packets: Efficient SIMD "
                                                "Single-Ray Traversal using Multi-branching BVHs",
                                                bvh8::kParams, bvh8::kAccel);
