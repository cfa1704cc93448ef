// kdtree.cpp -- the plugin of the kd-tree: its table, its build entry and its levels.
//
// Source: Wald, Havran 2006, "On building fast kd-Trees for Ray Tracing"; planes of large nodes: Hunt, Mark, Stoll 2006. A node
// takes 8 bytes, a leaf 4 more for each of its primitives; the traversal's stack has 12 bytes a level. Planes cut primitives,
// so cells do not overlap: a ray stops at its first hit, and tests fewer primitives than in a tree of boxes. It visits more
// nodes for that. Packets whose directions agree in sign go through the tree together: Wald, Slusallek, Benthin, Wagner 2001,
// "Interactive Rendering with Coherent Ray Tracing". The structure suits static scenes of unlike primitives, such as slanted or
// long ones. It is slow to build, and cannot be refitted.
#include "builder.hpp"

namespace kdtree {
namespace {

enum Param { kTraversal, kIntersection, kEmpty, kDepth };
constexpr rt_param kParams[] = {
    rt::float_param("traversal_cost", "Traversal cost", "cost of a node, in units of the heuristic", 0.01, 100, 2),
    clarity::space::kIntersectionCost,
    clarity::space::kEmptyBonus,
    clarity::space::kMaxDepth,
};

int32_t build(const rt_host* host, const rt_build_input* in, const rt_build_output* out) {
    const double* const params = in->params;
    const auto build_group = [&](const rt_group& group, rt_u32 max_depth, Box& box) {
        const Rules rules{params[kTraversal], params[kIntersection], params[kEmpty], max_depth};
        return build_tree(host, rules, in->prims + group.first, group.count, in->geometry->triangles, box);
    };
    rt::define(out, "KDTREE_STACK",
               clarity::space::build_groups<kdtree_head, Tree, Box>(host, *in, out, params[kDepth], build_group));
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
    clarity::space::show_level(head.node, clarity::space::box_of<Box>(head.box), level, sink, is_leaf, is_shown, part);
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
