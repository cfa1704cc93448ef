// bvh2.cpp -- the plugin of the binary BVH (binned surface area heuristic, SAH): its table and its build entry.
//
// Source: Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies". A node takes 64 bytes. n primitives make
// at most n - 1 nodes. The build measures the depth of the tree and defines the stack size of the traversal (BVH2_STACK) from
// it. The structure suits static scenes. It is weak where large and small primitives overlap; there builder=spatial helps.
#include <algorithm>
#include <vector>

#include "clarity_bvh/assemble.hpp"
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

// Lists the boxes of one level of a group's tree, for drawing.

// Passes the boxes of `level` to the sink: 0 is the root's box, RT_LEVEL_BOTTOM is all leaves. Throws if the group does not
// exist.
int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    if (group >= built->group_count) throw rt::fail(host, "was asked for the levels of a group that the scene does not have");
    const auto* nodes = static_cast<const bvh2_node*>(built->slots[0]);
    const auto show = [&](const float box[6]) { sink->box(sink->ctx, box, box + 3); };
    const auto is_empty_child = [](rt_u32 child) { return (child & BVH2_LEAF) && BVH2_LEAF_COUNT(child) == 0; };

    const bvh2_node& root = nodes[built->roots[group]];
    if (level == 0) {
        float box[6];
        for (int i = 0; i < 3; ++i) {
            box[i] = is_empty_child(root.child1) ? root.box0[i] : std::min(root.box0[i], root.box1[i]);
            box[3 + i] = is_empty_child(root.child1) ? root.box0[3 + i] : std::max(root.box0[3 + i], root.box1[3 + i]);
        }
        if (!is_empty_child(root.child0)) show(box);
        return RT_OK;
    }
    struct Visit {
        rt_u32 node, level;  // level of the node's children
    };
    std::vector<Visit> stack{{built->roots[group], 1}};
    while (!stack.empty()) {
        const Visit at = stack.back();
        stack.pop_back();
        const bvh2_node& node = nodes[at.node];
        const auto visit = [&](const float box[6], rt_u32 child) {
            if (is_empty_child(child)) return;
            const bool leaf = (child & BVH2_LEAF) != 0;
            if (level == RT_LEVEL_BOTTOM ? leaf : at.level == level)
                show(box);
            else if (!leaf)
                stack.push_back({child, at.level + 1});
        };
        visit(node.box0, node.child0);
        visit(node.box1, node.child1);
    }
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
