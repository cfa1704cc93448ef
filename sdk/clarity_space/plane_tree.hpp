// plane_tree.hpp -- a binary tree of planes, as builders of kd-trees and BSP trees write it. Header only, part of the SDK.
//
// Node has `code` and `at.first`. The lowest Bits bits of `code` name the plane, or are all set in a leaf. The others are the
// index of the child below the plane, and the child above is the next node; of a leaf they are the number of its primitives,
// and `at.first` is the place of their positions in the list.
#pragma once
#include <algorithm>
#include <cfloat>
#include <cmath>
#include <vector>

#include "clarity_space/tree.hpp"
#include "rt_cost.hpp"

namespace clarity::space {

// Parameters of their heuristic.
inline constexpr rt_param kIntersectionCost =
    rt::float_param("intersection_cost", "Intersection cost", "cost of a primitive, in units of the heuristic", 0.01, 100, 1.5);
inline constexpr rt_param kEmptyBonus = rt::float_param(
    "empty_bonus", "Empty bonus", "share of its cost that a plane saves which cuts off empty space", 0, 0.9, 0.2);
inline constexpr rt_param kMaxDepth = rt::int_param(
    "max_depth", "Max depth", "levels below the root, at most; 8 + 1.3 log2 of the primitives bounds them, too", 1, 64, 64);

// The root is the first node, and children stand behind their parents. The list has numbers of primitives within the group.
template <class Node, rt_u32 Bits>
struct PlaneTree {
    static constexpr rt_u32 kLeaf = (1u << Bits) - 1, kMostNodes = 1u << (32 - Bits);
    std::vector<Node> nodes;
    std::vector<rt_u32> list;
    rt_u32 depth = 0, leaves = 0;  // leaves: those with primitives
    rt::Surfaces surfaces{};       // of the nodes' cells; the builder adds those of inner nodes

    static bool is_leaf(const Node& node) { return (node.code & kLeaf) == kLeaf; }

    // Makes an existing node a leaf with these items, each of which has a `prim`. surface: of its cell.
    template <class Items>
    void make_leaf(size_t place, const Items& items, double surface) {
        surfaces.add_leaf(surface, double(items.size()));
        nodes[place].at.first = rt_u32(list.size());
        nodes[place].code = rt_u32(items.size()) << Bits | kLeaf;
        for (const auto& item : items) list.push_back(item.prim);
        leaves += !items.empty();
    }

    // Appends a tree, with its root in the place of an existing node.
    void append(size_t place, const PlaneTree& from) {
        const rt_u32 node = rt_u32(nodes.size()) - 1, first = rt_u32(list.size());  // the root is not appended
        for (size_t i = 0; i < from.nodes.size(); ++i) {
            Node moved = from.nodes[i];
            if (is_leaf(moved))
                moved.at.first += first;
            else
                moved.code += node << Bits;
            if (i == 0)
                nodes[place] = moved;
            else
                nodes.push_back(moved);
        }
        list.insert(list.end(), from.list.begin(), from.list.end());
        depth = std::max(depth, from.depth);
        leaves += from.leaves;
        surfaces.add(from.surfaces);
    }
};

// Builds the two children of a node as build(tree, place, side) does, on two threads if they are large.
template <class Tree, class Build>
void build_children(const rt_host* host, Tree& tree, size_t child, bool in_parallel, const Build& build) {
    if (!in_parallel) {
        build(tree, child, 0u);
        build(tree, child + 1, 1u);
        return;
    }
    Tree parts[2];
    rt::parallel_for(host, 2, [&](rt_u32 side) {
        parts[side].nodes.resize(1);
        build(parts[side], 0, side);
    });
    tree.append(child, parts[0]);
    tree.append(child + 1, parts[1]);
}

// The bounds of a group's primitives. What is not a number becomes the farthest bound, and infinite bounds become finite.
template <class Box>
Box finite_box(const rt_prim& p) {
    Box box;
    for (int k = 0; k < 3; ++k) {
        const float lo = p.lo[k] >= -FLT_MAX ? std::min(p.lo[k], FLT_MAX) : -FLT_MAX;
        const float hi = p.hi[k] <= FLT_MAX ? std::max(p.hi[k], -FLT_MAX) : FLT_MAX;
        box.lo[k] = std::min(lo, hi), box.hi[k] = std::max(lo, hi);
    }
    return box;
}

// The box around all of `count` boxes, box_at(0) to box_at(count - 1); of none: the origin.
template <class Box, class BoxAt>
Box box_around(rt_u32 count, const BoxAt& box_at) {
    Box all;
    for (int k = 0; k < 3; ++k) all.lo[k] = count > 0 ? FLT_MAX : 0, all.hi[k] = count > 0 ? -FLT_MAX : 0;
    for (rt_u32 i = 0; i < count; ++i) {
        const Box& box = box_at(i);
        for (int k = 0; k < 3; ++k) all.lo[k] = std::min(all.lo[k], box.lo[k]), all.hi[k] = std::max(all.hi[k], box.hi[k]);
    }
    return all;
}

// Writes the trees of all groups into the slots 0 (heads), 1 (nodes) and 2 (list), and their statistics. boxes: of each group.
// Returns the greatest depth.
template <class Head, class Tree, class Box>
rt_u32 put_trees(const rt_host* host, const rt_build_input& in, const rt_build_output* out, std::vector<Tree>& trees,
                 const std::vector<Box>& boxes) {
    auto* const heads = rt::alloc<Head>(out, 0, in.group_count);
    put_leaves(host, in, out, primitive_count(host, in));
    Tree all;
    rt::ExpectedCost expected;
    rt_u32 before = 0;  // positions in leaf order before the group's
    for (rt_u32 g = 0; g < in.group_count; ++g) {
        std::copy_n(boxes[g].lo, 3, heads[g].box);
        std::copy_n(boxes[g].hi, 3, heads[g].box + 3);
        heads[g].node = rt_u32(all.nodes.size());
        all.nodes.emplace_back();
        for (rt_u32& prim : trees[g].list) prim += before;
        expected.add_group(in.groups[g].count, rt::surface_of(boxes[g].lo, boxes[g].hi), trees[g].surfaces);
        all.append(heads[g].node, trees[g]);
        trees[g] = Tree();
        if (all.nodes.size() >= Tree::kMostNodes || all.list.size() > 0xFFFFFFF0u)
            throw rt::fail(host, "needs more nodes or names of primitives than it can number: lower `max_depth`");
        before += in.groups[g].count;
        rt::root(out, g, g);
    }
    using Node = typename decltype(all.nodes)::value_type;
    std::copy(all.nodes.begin(), all.nodes.end(), rt::alloc<Node>(out, 1, all.nodes.size()));
    std::copy(all.list.begin(), all.list.end(), rt::alloc<rt_u32>(out, 2, all.list.size()));
    rt::stat(out, "nodes", double(all.nodes.size()));
    rt::stat(out, "leaves", all.leaves);
    rt::stat(out, "references", double(all.list.size()));
    rt::stat(out, "depth", all.depth);
    expected.report(out);
    return all.depth;
}

// Builds and writes the tree of each group. build(group, most_depth, box) returns it, and the bounds of its primitives in
// `box`. max_depth: as the user asks. Returns the size of the traversal's stack.
template <class Head, class Tree, class Box, class Build>
rt_u32 build_groups(const rt_host* host, const rt_build_input& in, const rt_build_output* out, double max_depth,
                    const Build& build) {
    primitive_count(host, in);  // fails if there are too many
    std::vector<Tree> trees(in.group_count);
    std::vector<Box> boxes(in.group_count);
    rt::parallel_for(host, in.group_count, [&](rt_u32 g) {
        const double bound = 8 + 1.3 * std::log2(std::max(in.groups[g].count, 1u));
        trees[g] = build(in.groups[g], rt_u32(std::min(max_depth, bound)), boxes[g]);
    });
    return (put_trees<Head>(host, in, out, trees, boxes) + 8) / 8 * 8;
}

}  // namespace clarity::space
