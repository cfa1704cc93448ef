// bsp.cpp -- the plugin of the BSP tree: its table, its build entry and its levels.
//
// Source: Kammaje, Mora 2007, "A Study of Restricted BSP Trees for Ray Tracing": a BSP tree whose planes have one of few
// directions. So a node takes 8 bytes, as in a kd-tree, and a leaf 4 more for each of its primitives; the traversal's stack has
// 12 bytes a level. Oblique planes part what no axis parts: slanted strands, and neighbours in a slanted surface. So a ray
// tests a third fewer primitives than in a kd-tree. A plane costs it four times the arithmetic, and a build takes ten times as
// long, because the cells are polyhedra. It cannot be refitted.
#include <algorithm>
#include <cmath>

#include "builder.hpp"

namespace bsp {
namespace {

enum Param { kDirections, kObliqueBelow, kTraversalCost, kObliqueCost, kIntersectionCost, kEmptyBonus, kMaxDepth };
constexpr rt_param kParams[] = {
    rt::int_param("directions", "Directions",
                  "3 axes, 7 with the diagonals of a cube, 13 with those of its faces; 3 make a kd-tree", 3, BSP_DIRECTIONS,
                  BSP_DIRECTIONS),
    rt::int_param("oblique_below", "Oblique below", "nodes of more primitives are parted by planes of axes alone", 1,
                  1000000000, 3),
    rt::float_param("traversal_cost", "Traversal cost", "cost of a plane of an axis, in units of the heuristic", 0.01, 100, 1),
    rt::float_param("oblique_cost", "Oblique cost", "cost of another plane", 0.01, 100, 1),
    rt::float_param("intersection_cost", "Intersection cost", "cost of a primitive, in units of the heuristic", 0.01, 100, 1.5),
    rt::float_param("empty_bonus", "Empty bonus", "share of its cost that a plane saves which cuts off empty space", 0, 0.9,
                    0.2),
    rt::int_param("max_depth", "Max depth", "levels below the root, at most; 8 + 1.3 log2 of the primitives bounds them, too",
                  1, 64, 64),
};

int32_t build(const rt_host* host, const rt_build_input* in, const rt_build_output* out) {
    clarity::space::primitive_count(host, *in);  // fails if there are too many
    std::vector<Tree> trees(in->group_count);
    std::vector<Box> boxes(in->group_count);
    rt::parallel_for(host, in->group_count, [&](rt_u32 g) {
        const rt_group& group = in->groups[g];
        const double bound = 8 + 1.3 * std::log2(std::max(group.count, 1u));
        const Rules rules{in->params[kTraversalCost],
                          in->params[kObliqueCost],
                          in->params[kIntersectionCost],
                          in->params[kEmptyBonus],
                          rt_u32(in->params[kDirections]),
                          rt_u32(in->params[kObliqueBelow]),
                          rt_u32(std::min(in->params[kMaxDepth], bound))};
        trees[g] = build_tree(host, rules, in->prims + group.first, group.count, in->geometry->triangles, boxes[g]);
    });
    const rt_u32 depth = clarity::space::put_trees<bsp_head>(host, *in, out, trees, boxes);
    rt::define(out, "BSP_STACK", (depth + 8) / 8 * 8);
    return RT_OK;
}

// A level's cells are polyhedra, so the boxes around them overlap.
int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    if (group >= built->group_count) throw rt::fail(host, "was asked for the levels of a group that the scene does not have");
    const bsp_head& head = static_cast<const bsp_head*>(built->slots[0])[built->roots[group]];
    const auto* const nodes = static_cast<const bsp_node*>(built->slots[1]);
    struct Visit {
        rt_u32 node, level;
        Cell cell;
    };
    Box box;
    std::copy_n(head.box, 3, box.lo);
    std::copy_n(head.box + 3, 3, box.hi);
    std::vector<Visit> stack{{head.node, 0, Cell(box)}};
    while (!stack.empty()) {
        const Visit at = std::move(stack.back());
        stack.pop_back();
        const bsp_node& node = nodes[at.node];
        const bool leaf = Tree::is_leaf(node);
        if (level == RT_LEVEL_BOTTOM ? leaf : at.level == level) {
            if (leaf && node.code >> 4 == 0) continue;
            const Box shown = at.cell.empty() ? box : at.cell.box();
            sink->box(sink->ctx, shown.lo, shown.hi);
        } else if (!leaf) {
            for (rt_u32 side = 0; side < 2; ++side)
                stack.push_back({(node.code >> 4) + side, at.level + 1,
                                 at.cell.empty() ? at.cell : at.cell.half(node.code & BSP_LEAF, node.at.split, int(side))});
        }
    }
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
