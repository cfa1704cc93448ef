#include "tools/check/builds/pack_checks.hpp"

#include <algorithm>

#include "tools/check/builds/result_checks.hpp"

namespace clarity::check {
namespace {

rt_u32 add_halves(Halves& tree, const rt_prim* prims, rt_u32 count, rt_u32 leaf) {
    const auto at = static_cast<rt_u32>(tree.nodes.size());
    tree.nodes.emplace_back();
    rt_topology_node node{};
    if (count <= leaf) {
        node.left = static_cast<rt_u32>(tree.refs.size());
        node.right = RT_TOPOLOGY_LEAF | count;
        for (rt_u32 i = 0; i < count; ++i) tree.refs.push_back(prims[i].ref);
    } else {
        node.left = add_halves(tree, prims, count / 2, leaf);
        node.right = add_halves(tree, prims + count / 2, count - count / 2, leaf);
    }
    for (int k = 0; k < 3; ++k) {
        node.lo[k] = prims[0].lo[k];
        node.hi[k] = prims[0].hi[k];
        for (rt_u32 i = 1; i < count; ++i) {
            node.lo[k] = std::min(node.lo[k], prims[i].lo[k]);
            node.hi[k] = std::max(node.hi[k], prims[i].hi[k]);
        }
    }
    tree.nodes[at] = node;
    return at;
}

}  // namespace

Halves::Halves(const BuildScene& scene, rt_u32 leaf) {
    for (const rt_group& group : scene.groups)
        roots.push_back(group.count ? add_halves(*this, scene.prims.data() + group.first, group.count, leaf) : RT_NONE);
}

rt_topology Halves::topology() const {
    rt_topology topology{};
    topology.struct_bytes = sizeof topology;
    topology.group_count = static_cast<rt_u32>(roots.size());
    topology.nodes = nodes.data();
    topology.node_count = nodes.size();
    topology.refs = refs.data();
    topology.ref_count = refs.size();
    topology.roots = roots.data();
    return topology;
}

Problem pack_fault(const rt_plugin& layout, const BuildCase& input, rt_u32 leaf) {
    const Halves tree(input.scene(), leaf);
    BuildRun run = input.pack(layout, tree.topology());
    if (run.cancelled) return "said that it was cancelled, but nobody had cancelled it";
    if (run.why) return run.why;
    if (const Problem why = missing_refs(input.scene(), run.result)) return why;
    return layout.accel->levels ? loose_bounds(layout, input.scene(), run.result) : "";
}

}  // namespace clarity::check
