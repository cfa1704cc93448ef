// subtree.hpp -- builds the tree of one range on one thread, without allocating.
#pragma once
#include "partition.hpp"
#include "rt_plugin.h"
// after rt_types.h, whose types it uses:
#include "bvh2_types.h"

namespace bvh2 {

// Where a build keeps its things; one for all threads, each of which touches its own ranges only.
struct Workspace {
    Rules rules;
    Record* records[2];
    bvh2_node* nodes;  // as many as records: a range's nodes fit in the same places, for n primitives have at most n - 1
    rt_u32* leaves;    // refs in leaf order
};

struct Subtree {
    uint32_t root = 0;   // a leaf, or 0: the first of its nodes
    uint32_t nodes = 0;  // at workspace.nodes[range.begin]; children count from there
    uint32_t leaves = 0;
    uint32_t depth = 0;  // nodes from the root of the group to the deepest leaf
};

Subtree build_subtree(const Workspace& workspace, const Range& range);

// Decides about one range: false: a leaf. Else `left` and `right` are what it becomes, moved where they belong.
bool split_range(const Workspace& workspace, const Range& range, Bins& bins, Range& left, Range& right);

// Whether a range is better left whole. `area` is the scale that the split was found with.
inline bool leaf_is_better(const Rules& rules, const Range& range, const AreaScale& area, const Split& split) {
    if (range.count() > rules.max_leaf) return false;
    const float whole = area.half_area(range.box);
    const float as_leaf = rules.intersection_cost * static_cast<float>(range.count()) * whole;
    return !(rules.traversal_cost * whole + rules.intersection_cost * split.cost < as_leaf);
}

void set_child(bvh2_node& node, int which, const Box& box, uint32_t child);
inline float half_area(const float box[6]) {
    const float x = box[3] - box[0], y = box[4] - box[1], z = box[5] - box[2];
    return x * y + z * (x + y);
}
// The child of larger surface comes first: it is the one visited more often, and so the one to lie beside its parent.
inline bool right_is_larger(const Range& left, const Range& right) {
    Box both = left.box;
    both.add(right.box);
    const AreaScale area(both);
    return area.half_area(left.box) < area.half_area(right.box);
}

}  // namespace bvh2
