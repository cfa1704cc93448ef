// bsp.cpp -- the plugin of the BSP tree: its table, its build entry and its levels.
//
// Source: Kammaje, Mora 2007, "A Study of Restricted BSP Trees for Ray Tracing": a BSP tree whose planes have one of few
// directions. So a node takes 8 bytes, as in a kd-tree, and a leaf 4 more for each of its primitives; the traversal's stack has
// 12 bytes a level. Oblique planes part what no axis parts: slanted strands, and neighbours in a slanted surface. So a ray
// tests a third fewer primitives than in a kd-tree. A plane costs it four times the arithmetic, and a build takes ten times as
// long, because the cells are polyhedra. It cannot be refitted.
#include "builder.hpp"

namespace bsp {
namespace {

enum Param { kDirections, kObliqueBelow, kTraversal, kOblique, kIntersection, kEmpty, kDepth };
constexpr rt_param kParams[] = {
    rt::int_param("directions", "Directions",
                  "3 axes, 7 with the diagonals of a cube, 13 with those of its faces; 3 make a kd-tree", 3, BSP_DIRECTIONS,
                  BSP_DIRECTIONS),
    rt::int_param("oblique_below", "Oblique below", "nodes of more primitives are parted by planes of axes alone", 1,
                  1000000000, 3),
    rt::float_param("traversal_cost", "Traversal cost", "cost of a plane of an axis, in units of the heuristic", 0.01, 100, 1),
    rt::float_param("oblique_cost", "Oblique cost", "cost of another plane", 0.01, 100, 1),
    clarity::space::kIntersectionCost,
    clarity::space::kEmptyBonus,
    clarity::space::kMaxDepth,
};

int32_t build(const rt_host* host, const rt_build_input* in, const rt_build_output* out) {
    const double* const params = in->params;
    const auto build_group = [&](const rt_group& group, rt_u32 max_depth, Box& box) {
        const Rules rules{params[kTraversal],
                          params[kOblique],
                          params[kIntersection],
                          params[kEmpty],
                          rt_u32(params[kDirections]),
                          rt_u32(params[kObliqueBelow]),
                          max_depth};
        return build_tree(host, rules, in->prims + group.first, group.count, in->geometry->triangles, box);
    };
    rt::define(out, "BSP_STACK",
               clarity::space::build_groups<bsp_head, Tree, Box>(host, *in, out, params[kDepth], build_group));
    return RT_OK;
}

// A level's cells are polyhedra, so the boxes around them overlap.
int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    if (group >= built->group_count) throw rt::fail(host, "was asked for the levels of a group that the scene does not have");
    const bsp_head& head = static_cast<const bsp_head*>(built->slots[0])[built->roots[group]];
    const auto* const nodes = static_cast<const bsp_node*>(built->slots[1]);
    const Box box = clarity::space::box_of<Box>(head.box);
    using Visit = clarity::space::Visit<Cell>;
    const auto is_leaf = [&](rt_u32 node) { return Tree::is_leaf(nodes[node]); };
    const auto is_shown = [&](const Visit& at) { return !is_leaf(at.node) || nodes[at.node].code >> 4 != 0; };
    const auto part = [&](const Visit& at, std::vector<Visit>& stack) {
        const bsp_node& node = nodes[at.node];
        for (rt_u32 side = 0; side < 2; ++side)
            stack.push_back({(node.code >> 4) + side, at.level + 1,
                             at.cell.empty() ? at.cell : at.cell.half(node.code & BSP_LEAF, node.at.split, int(side))});
    };
    clarity::space::show_level(head.node, Cell(box), level, sink, is_leaf, is_shown, part,
                               [&](const Cell& cell) { return cell.empty() ? box : cell.box(); });
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "bsp.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<bsp_head>("bsp_heads", "bsp_head"), rt::slot<bsp_node>("bsp_nodes", "bsp_node"),
                              rt::slot<rt_u32>("bsp_list", "uint")};
constexpr rt_accel kAccel = rt::accel(kSlots, rt::file(kFiles, "bsp_types.h"), rt::file(kFiles, "bsp.cl"), rt::guarded<build>,
                                      rt::guarded<levels>, rt::Traits().can(RT_TRAVERSES_SINGLE_RAYS));
static_assert(sizeof(bsp_node) == 8, "eight nodes to a cache line");
static_assert(kAccel.types.text && kAccel.traverse.text, "the kernel files are embedded");

}  // namespace
}  // namespace bsp

const rt_plugin rt_plugin_v1 =
    rt::accel_plugin("bsp", "BSP tree (13 directions)", "1.0.0",
                     "Kammaje, Mora 2007, A Study of Restricted BSP Trees for Ray Tracing", bsp::kParams, bsp::kAccel);
