// kdtree.cpp -- the plugin of the kd-tree: its table, its build entry and its levels.
//
// Source: Wald, Havran 2006, "On building fast kd-Trees for Ray Tracing"; planes of large nodes: Hunt, Mark, Stoll 2006. A node
// takes 8 bytes, a leaf 4 more for each of its primitives; the traversal's stack has 12 bytes a level. Planes cut primitives,
// so cells do not overlap: a ray stops at its first hit, and tests fewer primitives than in a tree of boxes. It visits more
// nodes for that. Packets whose directions agree in sign go through the tree together: Wald, Slusallek, Benthin, Wagner 2001,
// "Interactive Rendering with Coherent Ray Tracing". The structure suits static scenes of unlike primitives, such as slanted or
// long ones. It is slow to build, and cannot be refitted.
#include <algorithm>
#include <cmath>
#include <vector>

#include "clarity_space/plane_tree.hpp"
#include "rt_plugin.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "kdtree_types.h"

namespace kdtree {
namespace {

// Builds a kd-tree by the surface area heuristic with perfect splits: Wald, Havran 2006, "On building fast
// kd-Trees for Ray Tracing, and on doing that in O(N log N)".
struct Box {
    float lo[3], hi[3];
};

// A primitive within a node: the bounds of its part there.
struct Item {
    Box box;
    rt_u32 prim;  // number within the group
};

// The cost of a ray in a node is `traversal`, that of a primitive in a leaf `intersection`.
struct Rules {
    double traversal, intersection;
    double empty_bonus;  // share of its cost that a plane saves which cuts off empty space
    rt_u32 max_depth;
};
using Tree = clarity::space::PlaneTree<kdtree_node, 2>;
static_assert(Tree::kLeaf == KDTREE_LEAF, "kernels know leaves by it");

constexpr size_t kExact = 2048;     // above this number of primitives only kBins planes an axis are tried
constexpr size_t kParallel = 8192;  // above this number two threads build the children
constexpr int kBins = 128;

// Half of the surface.
double area(const Box& b) {
    const double x = double{b.hi[0]} - b.lo[0], y = double{b.hi[1]} - b.lo[1], z = double{b.hi[2]} - b.lo[2];
    return x * y + y * z + z * x;
}

// The part of a box below (side 0) or above a plane.
Box half_of(Box box, int axis, float plane, int side) {
    (side == 0 ? box.hi : box.lo)[axis] = plane;
    return box;
}

// The bounds of the part of a triangle in a box (Sutherland, Hodgman 1974). Computed coordinates are rounded outwards.
Box clipped(const rt_packed_prim& t, const Box& to) {
    double corners[2][10][3];
    int count = 3;
    for (int k = 0; k < 3; ++k) corners[0][0][k] = t.a[k], corners[0][1][k] = t.b[k], corners[0][2][k] = t.c[k];
    int now = 0;
    for (int side = 0; side < 6; ++side) {
        const int axis = side % 3;
        const double plane = side < 3 ? to.lo[axis] : to.hi[axis], sign = side < 3 ? 1 : -1;
        int kept = 0;
        for (int i = 0; i < count; ++i) {
            const double *p = corners[now][i], *q = corners[now][(i + 1) % count];
            const double a = sign * (p[axis] - plane), b = sign * (q[axis] - plane);
            if (a >= 0) std::copy_n(p, 3, corners[1 - now][kept++]);
            if ((a > 0 && b < 0) || (a < 0 && b > 0)) {
                double* const x = corners[1 - now][kept++];
                for (int k = 0; k < 3; ++k) x[k] = k == axis ? plane : p[k] + (q[k] - p[k]) * (a / (a - b));
            }
        }
        count = kept, now = 1 - now;
    }
    if (count == 0) return to;  // by rounding: the triangle touches the box
    Box box;
    for (int k = 0; k < 3; ++k) {
        double lo = INFINITY, hi = -INFINITY;
        for (int i = 0; i < count; ++i) lo = std::min(lo, corners[now][i][k]), hi = std::max(hi, corners[now][i][k]);
        box.lo[k] = std::clamp(float(lo - 1.2e-7 * std::fabs(lo) - FLT_MIN), to.lo[k], to.hi[k]);
        box.hi[k] = std::clamp(float(hi + 1.2e-7 * std::fabs(hi) + FLT_MIN), to.lo[k], to.hi[k]);
    }
    return box;
}

struct Plane {
    double cost = INFINITY;
    int axis = 3;
    float at = 0;
};

class Builder {
 public:
    Builder(const rt_host* host, const Rules& rules, const rt_prim* prims, const rt_packed_prim* triangles)
        : host_(host), rules_(rules), prims_(prims), triangles_(triangles) {}

    // Writes the tree of these primitives, with its root in the place of an existing node.
    void build(Tree& tree, size_t place, std::vector<Item> items, const Box& box, rt_u32 depth) const {
        if (items.size() > 4096) rt::progress(host_, 0.5f);  // to notice a cancelled build
        tree.depth = std::max(tree.depth, depth);
        const Plane plane = depth < rules_.max_depth ? best_plane(items, box) : Plane();
        if (!(plane.cost < rules_.intersection * double(items.size()))) {
            tree.make_leaf(place, items, rt::surface_of(box.lo, box.hi));
            return;
        }
        tree.surfaces.add_node(rt::surface_of(box.lo, box.hi));
        const size_t child = tree.nodes.size();
        tree.nodes.resize(child + 2);
        tree.nodes[place].at.split = plane.at;
        tree.nodes[place].code = rt_u32(child) << 2 | rt_u32(plane.axis);
        std::vector<Item> halves[2];
        for (const Item& item : items) deal(item, plane, halves);
        const bool in_parallel = items.size() > kParallel;
        std::vector<Item>().swap(items);
        clarity::space::build_children(host_, tree, child, in_parallel, [&](Tree& to, size_t at, rt_u32 side) {
            build(to, at, std::move(halves[side]), half_of(box, plane.axis, plane.at, int(side)), depth + 1);
        });
    }

 private:
    const rt_host* host_;
    const Rules& rules_;
    const rt_prim* prims_;
    const rt_packed_prim* triangles_;

    // Puts a primitive into the halves that it has a part in. One within the plane goes below it.
    void deal(const Item& item, const Plane& plane, std::vector<Item> (&halves)[2]) const {
        const float lo = item.box.lo[plane.axis], hi = item.box.hi[plane.axis];
        if (hi <= plane.at) return halves[0].push_back(item);
        if (lo >= plane.at) return halves[1].push_back(item);
        const rt_u32 ref = prims_[item.prim].ref;
        for (int side = 0; side < 2; ++side) {
            const Box part = half_of(item.box, plane.axis, plane.at, side);
            const bool cuts = RT_REF_KIND(ref) == RT_REF_TRIANGLE && triangles_;
            halves[side].push_back({cuts ? clipped(triangles_[RT_REF_INDEX(ref)], part) : part, item.prim});
        }
    }

    void consider(Plane& best, const Box& box, int axis, float at, size_t below, size_t above) const {
        if (!(at > box.lo[axis] && at < box.hi[axis])) return;
        const double left = area(half_of(box, axis, at, 0)) / area(box), right = area(half_of(box, axis, at, 1)) / area(box);
        double cost = rules_.traversal + rules_.intersection * (left * double(below) + right * double(above));
        if (below == 0 || above == 0) cost *= 1 - rules_.empty_bonus;
        if (cost < best.cost) best = {cost, axis, at};
    }

    Plane best_plane(const std::vector<Item>& items, const Box& box) const {
        Plane best;
        if (items.empty() || !(area(box) > 0)) return best;
        for (int axis = 0; axis < 3; ++axis)
            if (items.size() > kExact)
                try_bins(best, items, box, axis);
            else
                try_bounds(best, items, box, axis);
        return best;
    }

    // All planes at which a primitive begins or ends. Those that begin before a plane, or lie in it, are below.
    void try_bounds(Plane& best, const std::vector<Item>& items, const Box& box, int axis) const {
        std::vector<float> begins, ends, flat;
        for (const Item& item : items) {
            const float lo = item.box.lo[axis], hi = item.box.hi[axis];
            if (lo == hi) flat.push_back(lo);
            begins.push_back(lo), ends.push_back(hi);
        }
        for (std::vector<float>* sorted : {&begins, &ends, &flat}) std::sort(sorted->begin(), sorted->end());
        size_t b = 0, e = 0, f = 0;
        while (b < begins.size() || e < ends.size()) {
            const float at = b < begins.size() ? std::min(begins[b], ends[e]) : ends[e];
            const size_t before = b;
            for (; f < flat.size() && flat[f] < at; ++f) {
            }
            size_t within = f;
            for (; within < flat.size() && flat[within] == at; ++within) {
            }
            for (; e < ends.size() && ends[e] == at; ++e) {
            }
            consider(best, box, axis, at, before + (within - f), items.size() - e);
            for (; b < begins.size() && begins[b] == at; ++b) {
            }
        }
    }

    // Planes at equal distances: Hunt, Mark, Stoll 2006, "Fast kd-tree Construction with an Adaptive Error-Bounded Heuristic".
    void try_bins(Plane& best, const std::vector<Item>& items, const Box& box, int axis) const {
        size_t begins[kBins] = {}, ends[kBins] = {}, below = 0, above = items.size();
        const double low = box.lo[axis], width = (double{box.hi[axis]} - low) / kBins;
        const auto bin = [&](float x) { return int(std::clamp((x - low) / width, 0.0, kBins - 1.0)); };
        if (!(width > 0)) return;
        for (const Item& item : items) ++begins[bin(item.box.lo[axis])], ++ends[bin(item.box.hi[axis])];
        for (int i = 1; i < kBins; ++i) {
            below += begins[i - 1], above -= ends[i - 1];
            consider(best, box, axis, float(low + i * width), below, above);
        }
    }
};

// Builds the tree of a group. `box` receives the bounds of its primitives.
Tree build_tree(const rt_host* host, const Rules& rules, const rt_prim* prims, rt_u32 count, const rt_packed_prim* triangles,
                Box& box) {
    std::vector<Item> items(count);
    for (rt_u32 i = 0; i < count; ++i) items[i] = {clarity::space::finite_box<Box>(prims[i]), i};
    box = clarity::space::box_around<Box>(count, [&](rt_u32 i) -> const Box& { return items[i].box; });
    Tree tree;
    tree.nodes.resize(1);
    Builder(host, rules, prims, triangles).build(tree, 0, std::move(items), box, 0);
    return tree;
}

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
