// bvh2.cpp -- the plugin of the binary BVH (binned surface area heuristic, SAH): its table and its build entry.
//
// Source: Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies". A node takes 64 bytes. n primitives make
// at most n - 1 nodes. The build measures the depth of the tree and defines the stack size of the traversal (BVH2_STACK) from
// it. The structure suits static scenes. It is weak where large and small primitives overlap; there builder=spatial helps.
#include "clarity_bvh/assemble.hpp"
#include "clarity_bvh/levels.hpp"
#include "clarity_bvh/refit/refit_binary.hpp"
#include "pack.hpp"
#include "parameters.hpp"
#include "rt_plugin.h"
#include "rt_plugin.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh2_types.h"

namespace bvh2 {
namespace {

// The extension `refit` of bvh2: new boxes for primitives that moved, in the same tree.
int32_t refit(const rt_host* host, const rt_refit_input* in, const rt_refit_output* out) {
    using namespace clarity::bvh;
    // pack.cpp asserts that a bvh2_node is a Node.
    BinaryRefit layout(static_cast<Node*>(out->slots[0]), in->slot_counts[0], in);
    const Rules rules = rules_of(in->params);
    Refit<BinaryRefit>(host, in, out, layout, {rules.traversal_cost, rules.intersection_cost}).run();
    return RT_OK;
}

int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    const auto* nodes = static_cast<const bvh2_node*>(built->slots[0]);
    clarity::bvh::show_level(host, built, group, level, sink, [&](rt_u32 at, const auto& visit) {
        const auto visit_child = [&](const float box[6], rt_u32 child) {
            const bool leaf = (child & BVH2_LEAF) != 0;
            if (!leaf || BVH2_LEAF_COUNT(child) > 0) visit(box, leaf ? RT_NONE : child);
        };
        visit_child(nodes[at].box0, nodes[at].child0);
        visit_child(nodes[at].box1, nodes[at].child1);
    });
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "bvh2.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<bvh2_node>("bvh2_nodes", "bvh2_node")};
constexpr rt_accel kAccel =
    rt::accel(kSlots, rt::file(kFiles, "bvh2_types.h"), rt::file(kFiles, "bvh2.cl"), rt::guarded<build>, rt::guarded<levels>,
              rt::Traits().merit(1, 1), rt::guarded<clarity::bvh::pack_trees<pack, BVH2_LEAF_MAX>>);
constexpr rt_refit kRefit = rt::refit(rt::guarded<refit>);
constexpr rt_extension kExtensions[] = {rt::extension(kRefit), rt::kNoMoreExtensions};
static_assert(sizeof(bvh2_node) == 64, "a node is a cache line");
static_assert(kAccel.types.text && kAccel.traverse.text, "the kernel files are embedded");

}  // namespace
}  // namespace bvh2

const rt_plugin rt_plugin_v1 = rt::with_extensions(
    rt::accel_plugin("bvh2", "Binary BVH (binned SAH)", "1.0.0",
                     "Wald 2007, On fast Construction of SAH-based Bounding Volume Hierarchies", bvh2::kParams, bvh2::kAccel),
    bvh2::kExtensions);
