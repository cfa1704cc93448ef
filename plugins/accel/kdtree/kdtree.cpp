// kdtree.cpp -- the plugin of the kd-tree: its table, its build entry and its levels.
//
// Source: Wald, Havran 2006, "On building fast kd-Trees for Ray Tracing"; planes of large nodes: Hunt, Mark, Stoll 2006. A node
// takes 8 bytes, a leaf 4 more for each of its primitives; the traversal's stack has 12 bytes a level. Planes cut primitives,
// so cells do not overlap: a ray stops at its first hit, and tests fewer primitives than in a tree of boxes. It visits more
// nodes for that. The structure suits static scenes of unlike primitives, such as slanted or long ones. It is slow to build,
// and cannot be refitted.
#include <algorithm>
#include <cmath>

#include "builder.hpp"
#include "clarity_space/tree.hpp"

namespace kdtree {
namespace {

enum Param { kTraversalCost, kIntersectionCost, kEmptyBonus, kMaxDepth };
constexpr rt_param kParams[] = {
    rt::float_param("traversal_cost", "Traversal cost", "cost of a node, in units of the heuristic", 0.01, 100, 1),
    rt::float_param("intersection_cost", "Intersection cost", "cost of a primitive, in units of the heuristic", 0.01, 100, 1.5),
    rt::float_param("empty_bonus", "Empty bonus", "share of its cost that a plane saves which cuts off empty space", 0, 0.9,
                    0.2),
    rt::int_param("max_depth", "Max depth", "levels below the root, at most; 8 + 1.3 log2 of the primitives bounds them, too",
                  1, 64, 64),
};

int32_t build(const rt_host* host, const rt_build_input* in, const rt_build_output* out) {
    const rt_u32 count = clarity::space::primitive_count(host, *in);
    std::vector<Tree> trees(in->group_count);
    std::vector<Box> boxes(in->group_count);
    rt::parallel_for(host, in->group_count, [&](rt_u32 g) {
        const rt_group& group = in->groups[g];
        const double bound = 8 + 1.3 * std::log2(std::max(group.count, 1u));
        const Rules rules{in->params[kTraversalCost], in->params[kIntersectionCost], in->params[kEmptyBonus],
                          rt_u32(std::min(in->params[kMaxDepth], bound))};
        trees[g] = build_tree(host, rules, in->prims + group.first, group.count, in->geometry->triangles, boxes[g]);
    });

    auto* const heads = rt::alloc<kdtree_head>(out, 0, in->group_count);
    clarity::space::put_leaves(host, *in, out, count);
    Tree all;
    rt_u32 before = 0;  // positions in leaf order before the group's
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        std::copy_n(boxes[g].lo, 3, heads[g].box);
        std::copy_n(boxes[g].hi, 3, heads[g].box + 3);
        heads[g].node = rt_u32(all.nodes.size());
        all.nodes.emplace_back();
        for (rt_u32& prim : trees[g].list) prim += before;
        append(all, heads[g].node, trees[g]);
        trees[g] = Tree();
        if (all.nodes.size() >= 1u << 30 || all.list.size() > 0xFFFFFFF0u)
            throw rt::fail(host, "needs more than 2^30 nodes or 2^32 names of primitives: lower `max_depth`");
        before += in->groups[g].count;
        rt::root(out, g, g);
    }
    std::copy(all.nodes.begin(), all.nodes.end(), rt::alloc<kdtree_node>(out, 1, all.nodes.size()));
    std::copy(all.list.begin(), all.list.end(), rt::alloc<rt_u32>(out, 2, all.list.size()));
    rt::define(out, "KDTREE_STACK", (all.depth + 8) / 8 * 8);
    rt::stat(out, "nodes", double(all.nodes.size()));
    rt::stat(out, "leaves", all.leaves);
    rt::stat(out, "references", double(all.list.size()));
    rt::stat(out, "depth", all.depth);
    return RT_OK;
}

int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    if (group >= built->group_count) throw rt::fail(host, "was asked for the levels of a group that the scene does not have");
    const kdtree_head& head = static_cast<const kdtree_head*>(built->slots[0])[built->roots[group]];
    const auto* const nodes = static_cast<const kdtree_node*>(built->slots[1]);
    using Visit = clarity::space::Visit<Box>;
    const auto is_leaf = [&](rt_u32 node) { return (nodes[node].code & 3u) == KDTREE_LEAF; };
    const auto is_shown = [&](const Visit& at) { return !is_leaf(at.node) || nodes[at.node].code >> 2 != 0; };
    const auto part = [&](const Visit& at, std::vector<Visit>& stack) {
        const kdtree_node& node = nodes[at.node];
        const rt_u32 axis = node.code & 3u, child = node.code >> 2;
        Visit below{child, at.level + 1, at.cell}, above{child + 1, at.level + 1, at.cell};
        below.cell.hi[axis] = above.cell.lo[axis] = node.at.split;
        stack.push_back(below);
        stack.push_back(above);
    };
    clarity::space::show_level<Box>(head.node, head.box, level, sink, is_leaf, is_shown, part);
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "kdtree.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<kdtree_head>("kdtree_heads", "kdtree_head"),
                              rt::slot<kdtree_node>("kdtree_nodes", "kdtree_node"), rt::slot<rt_u32>("kdtree_list", "uint")};
constexpr rt_accel kAccel = rt::accel(kSlots, rt::file(kFiles, "kdtree_types.h"), rt::file(kFiles, "kdtree.cl"),
                                      rt::guarded<build>, rt::guarded<levels>, rt::Traits().can(RT_TRAVERSES_SINGLE_RAYS));
static_assert(sizeof(kdtree_node) == 8, "eight nodes to a cache line");
static_assert(kAccel.types.text && kAccel.traverse.text, "the kernel files are embedded");

}  // namespace
}  // namespace kdtree

const rt_plugin rt_plugin_v1 =
    rt::accel_plugin("kdtree", "Kd-tree (SAH)", "1.0.0",
                     "Wald, Havran 2006, On building fast kd-Trees for Ray Tracing, and on doing that in O(N log N)",
                     kdtree::kParams, kdtree::kAccel);
