// bvh8.cpp -- the plugin of the BVH with eight children a node, the usual structure on a CPU: its table and its build entry.
//
// bvh2's builder makes a binary tree, and its nodes are merged by the surface area heuristic. A node takes 224 bytes; a
// triangle takes 58 to 60 bytes, its own record included. Both a single ray and the bounds of a coherent packet are tested
// against all eight children at once. The tree is shallow. A tree of only a few nodes is traced faster as bvh2, because packets
// there need no bounds.
#include "wide_build.hpp"
#include "wide_levels.hpp"

namespace bvh8 {
namespace {

// bvh4 compiles this file too, with another width. Its folder holds the differences.
#if BVH8_WIDTH == 4
#include "bvh4_table.inl"
#else
constexpr rt_cl_file kFiles[] = {
#include "bvh8.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<bvh8_node>("bvh8_nodes", "bvh8_node")};
static_assert(sizeof(bvh8_node) == 224, "rows are aligned vectors");
constexpr const char *kId = "bvh8", *kName = "8-wide BVH (binned SAH)", *kStack = "BVH8_STACK";
constexpr rt_cl_file kTypes = rt::file(kFiles, "bvh8_types.h"), kTraversal = rt::file(kFiles, "bvh8.cl");
constexpr rt::Traits kTraits = rt::Traits().can(RT_TRAVERSES_STREAMS | RT_SPLITS_INCOHERENT).merit(1.4f, 1.17f);

// How a CPU traces diverging packets: as packets, or as single rays.
constexpr int kIncoherent = kOwnParams;
enum Incoherent { kAuto, kPackets, kSingle };
constexpr const char* kIncoherentWays[] = {"auto", "packets", "single", nullptr};
// Size from which packets that diverge are traced as single rays. Trees of about this size outgrow a core's own cache. Measured
// with diffuse rays and frames (docs/experiments.md) on Sapphire Rapids, with 2 MiB of that cache and a slow third level:
// models of up to 70'000 triangles are traced faster as packets. At 86'000 and 100'000 triangles, single rays are as fast from
// close by, and 1.1 to 1.3 times as fast from afar. At a million, single rays are 1.2 to 1.6 times as fast.
constexpr uint64_t kTogether = 75'000;  // primitives
// Leaf size and cost that suit the kernels: a ray tests four triangles at the price of one, and the bounds of a packet spare it
// most leaves. Compared with leaves of four at a cost of 1, over the twelve views of the suite `cpu`: diffuse rays are 1.05
// times as fast, shadow rays 1.07, primary rays 1.03, and there are a third fewer nodes.
constexpr int kLeafSize = BVH8_LEAF_MAX;
constexpr double kLeafCost = 0.4;
#endif

constexpr rt_param kParams[] = {
    max_leaf_param(BVH8_LEAF_MAX, kLeafSize),
    kBinsParam,
    kTraversalParam,
    intersection_param(kLeafCost),
    kBuilderParam,
    kDuplicatesParam,
#if BVH8_WIDTH == 8
    rt::enum_param(
        "incoherent", "Incoherent rays",
        "how a CPU traces packets whose rays part: packets: together; single: each alone; auto: alone where the tree "
        "is larger than its caches",
        kIncoherentWays, kAuto),
#endif
};

int32_t build(const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
    const WideBuild wide = build_wide(host, input, out);
    report(out, wide, uint64_t{wide.nodes} * sizeof(bvh8_node));
    rt::define(out, kStack, stack_places(wide.stack));
#if BVH8_WIDTH == 8
    const auto incoherent = static_cast<Incoherent>(input->params[kIncoherent]);
    rt::define(out, "BVH8_SINGLE", incoherent == kSingle || (incoherent == kAuto && wide.primitives > kTogether));
#endif
    return RT_OK;
}

constexpr rt_accel kAccel = rt::accel(kSlots, kTypes, kTraversal, rt::guarded<build>, rt::guarded<levels>, kTraits);
static_assert(kAccel.types.text && kAccel.traverse.text, "the kernel files are embedded");

}  // namespace
}  // namespace bvh8

const rt_plugin rt_plugin_v1 = rt::accel_plugin(bvh8::kId, bvh8::kName, "1.0.0",
                                                "Wald, Benthin, Boulos 2008, Getting Rid of Packets: Efficient SIMD "
                                                "Single-Ray Traversal using Multi-branching BVHs",
                                                bvh8::kParams, bvh8::kAccel);
