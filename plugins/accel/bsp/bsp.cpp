// bsp.cpp -- the plugin of the BSP tree: its table, its build entry and its levels.
//
// Source: Kammaje, Mora 2007, "A Study of Restricted BSP Trees for Ray Tracing": a BSP tree whose planes have one of few
// directions. So a node takes 8 bytes, as in a kd-tree, and a leaf 4 more for each of its primitives; the traversal's stack has
// 12 bytes a level. Oblique planes part what no axis parts: slanted strands, and neighbours in a slanted surface. So a ray
// tests a third fewer primitives than in a kd-tree. A plane costs it four times the arithmetic, and a build takes ten times as
// long, because the cells are polyhedra. It cannot be refitted.
#include <algorithm>
#include <cmath>

#include "cell.hpp"
#include "clarity_space/plane_tree.hpp"

namespace bsp {
namespace {

// Builds a BSP tree with planes in few directions by the surface area heuristic: Kammaje, Mora 2007, "A Study of
// Restricted BSP Trees for Ray Tracing"; the surfaces of cells: Budge, Coming, Norpchen, Joy 2008, "Accelerated Building and
// Ray Tracing of Restricted BSP Trees".

// The cost of a ray at a plane of an axis is `traversal`, at another one `oblique`, that of a primitive in a leaf
// `intersection`.
struct Rules {
    double traversal, oblique, intersection;
    double empty_bonus;    // share of its cost that a plane saves which cuts off empty space
    rt_u32 directions;     // the first of BSP_DIRECTIONS
    rt_u32 oblique_below;  // nodes of more primitives are parted by axes alone
    rt_u32 max_depth;
};
using Tree = clarity::space::PlaneTree<bsp_node, 4>;
static_assert(Tree::kLeaf == BSP_LEAF && BSP_DIRECTIONS < BSP_LEAF, "kernels know leaves by it");

constexpr size_t kExact = 32;       // above this number of primitives only kBins planes a direction are tried
constexpr size_t kParallel = 2048;  // above this number two threads build the children
constexpr int kBins = 32;
constexpr rt_u32 kMostCorners = 9;

// The part of a primitive in a node: a polygon of the triangle, or the box of something else.
struct Item {
    rt_u32 prim;  // number within the group
    rt_u32 corner_count;
    bool is_polygon;
    float corners[kMostCorners][3];
};

struct Span {
    double lo = INFINITY, hi = -INFINITY;
};

Span span_of(rt_u32 k, const Item& item) {
    Span span;
    for (rt_u32 i = 0; i < item.corner_count; ++i) {
        const float* const p = item.corners[i];
        const double h = along(k, {p[0], p[1], p[2]});
        span.lo = std::min(span.lo, h), span.hi = std::max(span.hi, h);
    }
    return span;
}

// The part of a polygon below (side 0) or above a plane (Sutherland, Hodgman 1974). One that would have too many corners stays
// whole. Corners are rounded; the traversal has slack for that.
Item half_of(const Item& item, rt_u32 k, double at, int side) {
    Item half{item.prim, 0, true, {}};
    const double sign = side == 0 ? 1 : -1;
    const auto put = [&](const double(&p)[3]) {
        if (half.corner_count < kMostCorners)
            for (int i = 0; i < 3; ++i) half.corners[half.corner_count][i] = float(p[i]);
        ++half.corner_count;
    };
    for (rt_u32 i = 0; i < item.corner_count; ++i) {
        const float *const p = item.corners[i], *const q = item.corners[(i + 1) % item.corner_count];
        const double a = sign * (along(k, {p[0], p[1], p[2]}) - at), b = sign * (along(k, {q[0], q[1], q[2]}) - at);
        if (a <= 0) put({p[0], p[1], p[2]});
        if ((a < 0 && b > 0) || (a > 0 && b < 0)) {
            const double t = a / (a - b);
            put({p[0] + t * (double{q[0]} - p[0]), p[1] + t * (double{q[1]} - p[1]), p[2] + t * (double{q[2]} - p[2])});
        }
    }
    return half.corner_count == 0 || half.corner_count > kMostCorners ? item : half;
}

struct Plane {
    double cost = INFINITY;
    rt_u32 direction = BSP_LEAF;
    float at = 0;
};

class Builder {
 public:
    Builder(const rt_host* host, const Rules& rules) : host_(host), rules_(rules) {}

    // Writes the tree of these primitives, with its root in the place of an existing node.
    void build(Tree& tree, size_t place, std::vector<Item> items, const Cell& cell, rt_u32 depth) const {
        if (items.size() > 1024) rt::progress(host_, 0.5f);  // to notice a cancelled build
        tree.depth = std::max(tree.depth, depth);
        const Plane plane = depth < rules_.max_depth ? best_plane(items, cell) : Plane();
        if (!(plane.cost < rules_.intersection * double(items.size()))) return tree.make_leaf(place, items, cell.surface());
        tree.surfaces.add_node(cell.surface());
        const size_t child = tree.nodes.size();
        tree.nodes.resize(child + 2);
        tree.nodes[place].at.split = plane.at;
        tree.nodes[place].code = rt_u32(child) << 4 | plane.direction;
        std::vector<Item> halves[2];
        for (const Item& item : items) deal(item, plane, halves);
        const bool in_parallel = items.size() > kParallel;
        std::vector<Item>().swap(items);
        clarity::space::build_children(host_, tree, child, in_parallel, [&](Tree& to, size_t at, rt_u32 side) {
            build(to, at, std::move(halves[side]), cell.half(plane.direction, plane.at, int(side)), depth + 1);
        });
    }

 private:
    const rt_host* host_;
    const Rules& rules_;

    // Puts a primitive into the halves that it has a part in. One within the plane goes below it.
    static void deal(const Item& item, const Plane& plane, std::vector<Item> (&halves)[2]) {
        const Span span = span_of(plane.direction, item);
        if (span.hi <= plane.at) return halves[0].push_back(item);
        if (span.lo >= plane.at) return halves[1].push_back(item);
        for (int side = 0; side < 2; ++side) {
            halves[side].push_back(item.is_polygon ? half_of(item, plane.direction, plane.at, side) : item);
            if (item.is_polygon || plane.direction > 2) continue;
            for (float(&corner)[3] : halves[side].back().corners) {
                float& x = corner[plane.direction];
                x = side == 0 ? std::min(x, plane.at) : std::max(x, plane.at);
            }
        }
    }

    void consider(Plane& best, const Cell& cell, const Profile& profile, rt_u32 k, double at, size_t below,
                  size_t above) const {
        const float plane = float(at);
        if (!(plane > profile.low && plane < profile.high && std::fabs(plane) < 1e30f)) return;
        const double left = profile.part(profile.below, plane) / cell.surface(),
                     right = profile.part(profile.above, plane) / cell.surface();
        double cost =
            (k < 3 ? rules_.traversal : rules_.oblique) + rules_.intersection * (left * double(below) + right * double(above));
        if (below == 0 || above == 0) cost *= 1 - rules_.empty_bonus;
        if (cost < best.cost) best = {cost, k, plane};
    }

    Plane best_plane(const std::vector<Item>& items, const Cell& cell) const {
        Plane best;
        // A plane must save more than it costs itself.
        if (rules_.intersection * double(items.size()) <= rules_.traversal || cell.empty()) return best;
        std::vector<Span> spans(items.size());
        // Large nodes are parted by axes, as Ize, Wald, Parker 2008 do ("Ray Tracing with the BSP Tree"). Oblique planes would
        // cut off their corners and make them round, and what is round has no plane that pays: either half has three quarters
        // of its surface.
        const rt_u32 directions = items.size() > rules_.oblique_below ? 3 : rules_.directions;
        for (rt_u32 k = 0; k < directions; ++k) {
            const Profile profile = cell.profile(k);
            if (!(profile.high - profile.low > 0) || !std::isfinite(profile.high - profile.low)) continue;
            for (size_t i = 0; i < items.size(); ++i) spans[i] = span_of(k, items[i]);
            if (items.size() > kExact)
                try_bins(best, spans, cell, profile, k);
            else
                try_bounds(best, spans, cell, profile, k);
        }
        return best;
    }

    // Planes at which a primitive begins or ends. A plane is a float: one at a begin is moved below it, one at an end above it.
    void try_bounds(Plane& best, const std::vector<Span>& spans, const Cell& cell, const Profile& profile, rt_u32 k) const {
        const auto try_plane = [&](float at) {
            size_t below = 0, above = 0;
            for (const Span& span : spans) {
                const bool is_below = span.hi <= at;
                below += is_below || span.lo < at, above += !is_below && span.hi > at;
            }
            consider(best, cell, profile, k, at, below, above);
        };
        for (const Span& span : spans) {
            const float lo = float(span.lo), hi = float(span.hi);
            try_plane(lo > span.lo ? std::nextafter(lo, -INFINITY) : lo);
            try_plane(hi < span.hi ? std::nextafter(hi, INFINITY) : hi);
        }
    }

    // Planes at equal distances: Hunt, Mark, Stoll 2006, "Fast kd-tree Construction with an Adaptive Error-Bounded Heuristic".
    void try_bins(Plane& best, const std::vector<Span>& spans, const Cell& cell, const Profile& profile, rt_u32 k) const {
        size_t begins[kBins] = {}, ends[kBins] = {}, below = 0, above = spans.size();
        const double low = profile.low, width = (profile.high - low) / kBins;
        const auto bin = [&](double x) { return int(std::clamp((x - low) / width, 0.0, kBins - 1.0)); };
        for (const Span& span : spans) ++begins[bin(span.lo)], ++ends[bin(span.hi)];
        for (int i = 1; i < kBins; ++i) {
            below += begins[i - 1], above -= ends[i - 1];
            consider(best, cell, profile, k, low + i * width, below, above);
        }
    }
};

Item item_of(const rt_prim& prim, rt_u32 number, const rt_packed_prim* triangles) {
    Item item{number, 0, false, {}};
    if (RT_REF_KIND(prim.ref) == RT_REF_TRIANGLE && triangles) {
        const rt_packed_prim& t = triangles[RT_REF_INDEX(prim.ref)];
        item.is_polygon = true, item.corner_count = 3;
        for (int k = 0; k < 3; ++k) item.corners[0][k] = t.a[k], item.corners[1][k] = t.b[k], item.corners[2][k] = t.c[k];
        return item;
    }
    const Box box = clarity::space::finite_box<Box>(prim);
    item.corner_count = 8;
    for (int i = 0; i < 8; ++i)
        for (int k = 0; k < 3; ++k) item.corners[i][k] = (i >> k & 1 ? box.hi : box.lo)[k];
    return item;
}

// Builds the tree of a group. `box` receives the bounds of its primitives.
Tree build_tree(const rt_host* host, const Rules& rules, const rt_prim* prims, rt_u32 count, const rt_packed_prim* triangles,
                Box& box) {
    std::vector<Item> items(count);
    for (rt_u32 i = 0; i < count; ++i) items[i] = item_of(prims[i], i, triangles);
    box = clarity::space::box_around<Box>(count, [&](rt_u32 i) { return clarity::space::finite_box<Box>(prims[i]); });
    Tree tree;
    tree.nodes.resize(1);
    Builder(host, rules).build(tree, 0, std::move(items), Cell(box), 0);
    return tree;
}

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
