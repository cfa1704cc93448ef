// octree.cpp -- an octree for each group: Glassner 1984, "Space Subdivision for Fast Ray Tracing". A cell is parted at its
// middle as long as the surface area heuristic gains by it (MacDonald, Booth 1990, "Heuristics for Ray Tracing using Space
// Subdivision").
//
// A node takes 16 bytes, a leaf 4 more for each of its primitives; the traversal's stack has 84 bytes a level. An octree
// follows the scene where a grid cannot: small things in a large scene get small cells. It is quicker to build than a kd-tree,
// whose planes lie where they gain most; these lie in the middle. So rays visit more cells and test more primitives than in a
// kd-tree.
#include <algorithm>
#include <cfloat>
#include <cmath>
#include <vector>

#include "clarity_space/primitives.hpp"
#include "clarity_space/tree.hpp"
#include "rt_cost.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "octree_types.h"

namespace {

using clarity::space::is_huge;
using clarity::space::kEps;
using clarity::space::TrianglePlane;

enum Param { kTraversalCost, kMaxDepth };
constexpr rt_param kParams[] = {
    rt::float_param("traversal_cost", "Traversal cost", "cost of parting a cell, in primitives", 0.1, 100, 6),
    rt::int_param("max_depth", "Max depth",
                  "levels below the root, at most; 2 + half of log2 of the primitives bounds them, too", 1, 16, 16),
};

struct Cell {
    float lo[3], hi[3];
    Cell child(rt_u32 i, const float center[3]) const {
        Cell c = *this;
        for (int k = 0; k < 3; ++k) (i >> k & 1 ? c.lo : c.hi)[k] = center[k];
        return c;
    }
};

// The tree of one group.
struct Tree {
    const rt_host* host;
    const rt_prim* prims;
    const rt_packed_prim* triangles;
    double traversal_cost;
    rt_u32 max_depth;
    octree_head head{};
    Cell root{};  // a cube around the box
    std::vector<octree_node> nodes = std::vector<octree_node>(1);
    std::vector<rt_u32> list{};
    rt_u32 depth = 0, leaves = 0;
    rt::Surfaces surfaces{};

    void build(rt_u32 count) {
        std::vector<rt_u32> all(count);
        float* const lo = head.box;
        float* const hi = head.box + 3;
        for (int k = 0; k < 3; ++k) lo[k] = count > 0 ? FLT_MAX : 0, hi[k] = count > 0 ? -FLT_MAX : 0;
        double longest = 0;
        Cell inner{{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};  // without huge primitives
        for (rt_u32 i = 0; i < count; ++i) {
            all[i] = i;
            for (int k = 0; k < 3; ++k) {
                lo[k] = std::min(lo[k], prims[i].lo[k] >= -FLT_MAX ? prims[i].lo[k] : -FLT_MAX);
                hi[k] = std::max(hi[k], prims[i].hi[k] <= FLT_MAX ? prims[i].hi[k] : FLT_MAX);
                if (is_huge(prims[i])) continue;
                inner.lo[k] = std::min(inner.lo[k], prims[i].lo[k]), inner.hi[k] = std::max(inner.hi[k], prims[i].hi[k]);
            }
        }
        for (int k = 0; k < 3; ++k) longest = std::max(longest, double{inner.hi[k]} - inner.lo[k]);
        // The cells at the root's border reach as far as the box: nothing is outside of all cells.
        for (int k = 0; k < 3; ++k) root.lo[k] = inner.lo[k], root.hi[k] = float(inner.lo[k] + longest);
        part(0, std::move(all), root, 0);
    }

    // Of what is within the box: rays do not see the rest of the cube.
    double surface(const Cell& cell) const {
        Cell within = cell;
        for (int k = 0; k < 3; ++k) {
            within.lo[k] = std::clamp(cell.lo[k], head.box[k], head.box[k + 3]);
            within.hi[k] = std::clamp(cell.hi[k], head.box[k], head.box[k + 3]);
        }
        return rt::surface_of(within.lo, within.hi);
    }

    void part(size_t place, std::vector<rt_u32> here, const Cell& cell, rt_u32 level) {
        if (here.size() > 2048) rt::progress(host, 0.5f);  // to notice a cancelled build
        depth = std::max(depth, level);
        std::vector<rt_u32> below[8];
        float center[3];
        bool splits = (level < max_depth) && (traversal_cost < double(here.size()));
        for (int k = 0; k < 3; ++k) {
            center[k] = float(0.5 * (double{cell.lo[k]} + cell.hi[k]));
            splits = splits && cell.lo[k] < center[k] && center[k] < cell.hi[k];
        }
        if (splits) {
            // A ray in the cell visits a child with the share of the surfaces, a quarter.
            size_t sum = 0;
            for (const rt_u32 prim : here) deal(prim, cell, center, below);
            for (const std::vector<rt_u32>& child : below) sum += child.size();
            splits = traversal_cost + 0.25 * double(sum) < double(here.size());
        }
        if (!splits) {
            nodes[place].at.first = rt_u32(list.size());
            nodes[place].code = OCTREE_LEAF | rt_u32(here.size());
            list.insert(list.end(), here.begin(), here.end());
            leaves += !here.empty();
            surfaces.add_leaf(surface(cell), double(here.size()));
            return;
        }
        surfaces.add_node(surface(cell));
        std::vector<rt_u32>().swap(here);
        const size_t first = nodes.size();
        nodes.resize(first + 8);
        std::copy_n(center, 3, nodes[place].at.center);
        nodes[place].code = rt_u32(first);
        for (rt_u32 i = 0; i < 8; ++i) part(first + i, std::move(below[i]), cell.child(i, center), level + 1);
    }

    // Puts a primitive into the children that its box and, of a triangle, its plane meet. A plane belongs to both sides.
    void deal(rt_u32 prim, const Cell& cell, const float center[3], std::vector<rt_u32> (&below)[8]) const {
        const rt_prim& p = prims[prim];
        rt_u32 sides[3], met = 0;
        for (int k = 0; k < 3; ++k) sides[k] = (p.lo[k] > center[k] ? 0u : 1u) | (p.hi[k] < center[k] ? 0u : 2u);
        for (int k = 0; k < 3; ++k) met += sides[k] == 3;
        const bool cuts = met > 1 && triangles && RT_REF_KIND(p.ref) == RT_REF_TRIANGLE && !is_huge(p);
        for (rt_u32 i = 0; i < 8; ++i) {
            if (!(sides[0] >> (i & 1) & 1) || !(sides[1] >> (i >> 1 & 1) & 1) || !(sides[2] >> (i >> 2) & 1)) continue;
            if (cuts) {
                const Cell child = cell.child(i, center);
                double middle[3], half[3];
                for (int k = 0; k < 3; ++k) {
                    middle[k] = 0.5 * (double{child.lo[k]} + child.hi[k]);
                    half[k] = 0.5 * (double{child.hi[k]} - child.lo[k]) +
                              16 * kEps * std::max(std::fabs(cell.lo[k]), std::fabs(cell.hi[k]));
                }
                if (!TrianglePlane(triangles[RT_REF_INDEX(p.ref)]).meets(middle, half)) continue;
            }
            below[i].push_back(prim);
        }
    }
};

int32_t build(const rt_host* host, const rt_build_input* in, const rt_build_output* out) {
    const rt_u32 count = clarity::space::primitive_count(host, *in);
    uint64_t node_count = 0, references = 0;
    std::vector<Tree> trees;
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        const rt_group& group = in->groups[g];
        const double bound = 2 + 0.5 * std::log2(std::max(group.count, 1u));
        trees.push_back({host, in->prims + group.first, in->geometry->triangles, in->params[kTraversalCost],
                         rt_u32(std::min(in->params[kMaxDepth], bound))});
    }
    rt::parallel_for(host, in->group_count, [&](rt_u32 g) { trees[g].build(in->groups[g].count); });
    for (const Tree& tree : trees) node_count += tree.nodes.size(), references += tree.list.size();
    if (node_count >= OCTREE_LEAF || references > 0xFFFFFFF0u)
        throw rt::fail(host, "needs more than 2^31 nodes or 2^32 names of primitives: lower `max_depth`");

    auto* const heads = rt::alloc<octree_head>(out, 0, in->group_count);
    auto* const nodes = rt::alloc<octree_node>(out, 1, node_count);
    rt_u32* list = rt::alloc<rt_u32>(out, 2, references);
    clarity::space::put_leaves(host, *in, out, count);
    rt_u32 node = 0, name = 0, before = 0, depth = 0, leaves = 0;
    rt::ExpectedCost expected;
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        const Tree& tree = trees[g];
        heads[g] = tree.head;
        heads[g].node = node;
        for (size_t i = 0; i < tree.nodes.size(); ++i) {
            octree_node moved = tree.nodes[i];
            (moved.code & OCTREE_LEAF ? moved.at.first : moved.code) += moved.code & OCTREE_LEAF ? name : node;
            nodes[node + i] = moved;
        }
        for (const rt_u32 prim : tree.list) *list++ = before + prim;
        node += rt_u32(tree.nodes.size()), name += rt_u32(tree.list.size()), before += in->groups[g].count;
        depth = std::max(depth, tree.depth), leaves += tree.leaves;
        expected.add_group(in->groups[g].count, rt::surface_of(tree.head.box), tree.surfaces);
        rt::root(out, g, g);
    }
    rt::define(out, "OCTREE_STACK", (7 * depth + 16) / 16 * 16);
    rt::stat(out, "nodes", double(node_count));
    rt::stat(out, "leaves", leaves);
    rt::stat(out, "references", double(references));
    rt::stat(out, "depth", depth);
    expected.report(out);
    return RT_OK;
}

// Border cells reach as far as the group's box, as rays see them.
int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    if (group >= built->group_count) throw rt::fail(host, "was asked for the levels of a group that the scene does not have");
    const octree_head& head = static_cast<const octree_head*>(built->slots[0])[built->roots[group]];
    const auto* const nodes = static_cast<const octree_node*>(built->slots[1]);
    using Visit = clarity::space::Visit<Cell>;
    const auto is_leaf = [&](rt_u32 node) { return (nodes[node].code & OCTREE_LEAF) != 0; };
    const auto is_shown = [&](const Visit& at) {
        bool is_inside = true;
        for (int k = 0; k < 3; ++k) is_inside = is_inside && at.cell.lo[k] <= at.cell.hi[k];
        return is_inside && nodes[at.node].code != OCTREE_LEAF;
    };
    const auto part = [&](const Visit& at, std::vector<Visit>& stack) {
        const octree_node& node = nodes[at.node];
        for (rt_u32 i = 0; i < 8; ++i) stack.push_back({node.code + i, at.level + 1, at.cell.child(i, node.at.center)});
    };
    clarity::space::show_level(head.node, clarity::space::box_of<Cell>(head.box), level, sink, is_leaf, is_shown, part);
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "octree.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<octree_head>("octree_heads", "octree_head"),
                              rt::slot<octree_node>("octree_nodes", "octree_node"), rt::slot<rt_u32>("octree_list", "uint")};
constexpr rt_accel kAccel = rt::accel(kSlots, rt::file(kFiles, "octree_types.h"), rt::file(kFiles, "octree.cl"),
                                      rt::guarded<build>, rt::guarded<levels>, rt::Traits().can(RT_TRAVERSES_SINGLE_RAYS));
static_assert(sizeof(octree_node) == 16, "four nodes to a cache line");
static_assert(kAccel.types.text && kAccel.traverse.text, "the kernel files are embedded");

}  // namespace

const rt_plugin rt_plugin_v1 =
    rt::accel_plugin("octree", "Octree", "1.0.0", "Glassner 1984, Space Subdivision for Fast Ray Tracing", kParams, kAccel);
