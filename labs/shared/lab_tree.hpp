// lab_tree.hpp -- binary trees over the primitives of a group, for labs. How a node is split is the caller's choice.
#pragma once
#include <algorithm>
#include <vector>

#include "rt_plugin.hpp"

namespace lab {

struct Box {
    float lo[3] = {3e38f, 3e38f, 3e38f}, hi[3] = {-3e38f, -3e38f, -3e38f};
    // Encloses also what lies between two corners: add(prim.lo, prim.hi), add(other.lo, other.hi).
    void add(const float* other_lo, const float* other_hi) {
        for (int axis = 0; axis < 3; ++axis)
            lo[axis] = std::min(lo[axis], other_lo[axis]), hi[axis] = std::max(hi[axis], other_hi[axis]);
    }
    // Half of its surface; 0 if nothing was added.
    float surface() const {
        const float x = hi[0] - lo[0], y = hi[1] - lo[1], z = hi[2] - lo[2];
        return x < 0 ? 0 : x * y + y * z + z * x;
    }
};

// Twice the centre of a primitive's box: only the order matters.
inline float centre(const rt_prim& prim, int axis) {
    return prim.lo[axis] + prim.hi[axis];
}

// Puts the half with the lesser centres first, across the longest axis of the box. Returns where the other half begins; of two
// and fewer primitives `begin`: they become a leaf.
inline rt_prim* split_at_median(const Box& box, rt_prim* begin, rt_prim* end) {
    if (end - begin <= 2) return begin;
    int axis = 0;
    for (int k = 1; k < 3; ++k)
        if (box.hi[k] - box.lo[k] > box.hi[axis] - box.lo[axis]) axis = k;
    rt_prim* const middle = begin + (end - begin) / 2;
    std::nth_element(begin, middle, end,
                     [axis](const rt_prim& a, const rt_prim& b) { return centre(a, axis) < centre(b, axis); });
    return middle;
}

// A tree. Node 0 is the root, and children come behind their parents. A leaf is a range of `order`; without primitives there is
// no node.
struct Tree {
    std::vector<rt_topology_node> nodes;
    std::vector<rt_u32> order;  // refs
};

// split(box, begin, end): as split_at_median().
template <class Split>
Tree make_tree(const rt_prim* prims, rt_u32 count, Split split) {
    std::vector<rt_prim> sorted(prims, prims + count);
    Tree tree;
    struct Maker {
        Tree& tree;
        Split& split;
        rt_u32 node(rt_prim* begin, rt_prim* end, rt_u32 level) {
            Box box;
            for (const rt_prim* prim = begin; prim < end; ++prim) box.add(prim->lo, prim->hi);
            const rt_u32 at = rt_u32(tree.nodes.size()), first = rt_u32(tree.order.size());
            tree.nodes.push_back({{box.lo[0], box.lo[1], box.lo[2]},
                                  first,
                                  {box.hi[0], box.hi[1], box.hi[2]},
                                  RT_TOPOLOGY_LEAF | rt_u32(end - begin)});
            // Halves end: no tree is deeper than RT_TOPOLOGY_DEPTH.
            rt_prim* const middle = level < 128 ? split(box, begin, end) : split_at_median(box, begin, end);
            if (middle == begin || middle == end) {
                for (const rt_prim* prim = begin; prim < end; ++prim) tree.order.push_back(prim->ref);
            } else {
                const rt_u32 left = node(begin, middle, level + 1), right = node(middle, end, level + 1);
                tree.nodes[at].left = left, tree.nodes[at].right = right;
            }
            return at;
        }
    } maker{tree, split};
    if (count > 0) maker.node(sorted.data(), sorted.data() + count, 0);
    return tree;
}

// Hands over the trees of all groups.
inline void put_trees(const rt_topology_output* out, const std::vector<Tree>& trees) {
    uint64_t node_count = 0, ref_count = 0;
    for (const Tree& tree : trees) node_count += tree.nodes.size(), ref_count += tree.order.size();
    rt_topology_node* const nodes = rt::nodes(out, node_count);
    rt_u32* const refs = rt::refs(out, ref_count);
    rt_u32 node_at = 0, ref_at = 0;
    for (size_t g = 0; g < trees.size(); ++g) {
        const Tree& tree = trees[g];
        rt::root(out, rt_u32(g), tree.nodes.empty() ? RT_NONE : node_at);
        for (size_t i = 0; i < tree.nodes.size(); ++i) {
            rt_topology_node node = tree.nodes[i];
            const bool is_leaf = node.right & RT_TOPOLOGY_LEAF;
            node.left += is_leaf ? ref_at : node_at, node.right += is_leaf ? 0 : node_at;
            nodes[node_at + i] = node;
        }
        std::copy(tree.order.begin(), tree.order.end(), refs + ref_at);
        node_at += rt_u32(tree.nodes.size()), ref_at += rt_u32(tree.order.size());
    }
}

}  // namespace lab
