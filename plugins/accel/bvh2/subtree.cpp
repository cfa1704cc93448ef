#include "subtree.hpp"

namespace bvh2 {

void set_child(bvh2_node& node, int which, const Box& box, uint32_t child) {
    alignas(16) float lo[4], hi[4];
    store(lo, box.lo);
    store(hi, box.hi);
    float* out = which == 0 ? node.box0 : node.box1;
    for (int axis = 0; axis < 3; ++axis) {
        out[axis] = lo[axis];
        out[3 + axis] = hi[axis];
    }
    (which == 0 ? node.child0 : node.child1) = child;
}

bool split_range(const Workspace& w, const Range& range, Bins& bins, Range& left, Range& right) {
    const uint32_t count = range.count();
    Record* const from = w.records[range.buffer];
    if (may_use_heuristic(w.rules, range)) {
        const uint32_t bin_count = bins_for(w.rules, count);
        const Slices slices(range.centroids2, bin_count);
        bins.clear(bin_count);
        bins.add(from + range.begin, from + range.end, slices);
        const AreaScale area(range.box);
        const Split split = find_split(bins, bin_count, area, count);
        if (leaf_is_better(w.rules, range, area, split)) return false;
        if (split.cost < INFINITY) {
            Record* const to = w.records[range.buffer ^ 1];
            begin_split(range, split, left, right);
            scatter(from + range.begin, from + range.end, slices, split, to + left.begin, to + right.begin, left.centroids2,
                    right.centroids2);
            return true;
        }
    }
    if (count <= w.rules.max_leaf) return false;
    halve(from, range, left, right);
    return true;
}

namespace {

class Builder {
 public:
    Builder(const Workspace& workspace, const Range& range) : w_(workspace), nodes_(workspace.nodes + range.begin) {}

    uint32_t build(const Range& range) {
        Range left, right;
        if (range.count() == 1 || !split_range(w_, range, bins_, left, right)) return make_leaf(range);
        if (right_is_larger(left, right)) std::swap(left, right);
        const uint32_t at = result.nodes++;
        set_child(nodes_[at], 0, left.box, 0);
        set_child(nodes_[at], 1, right.box, 0);
        nodes_[at].pad0 = nodes_[at].pad1 = 0;
        nodes_[at].child0 = build(left);
        nodes_[at].child1 = build(right);
        return at;
    }

    Subtree result;

 private:
    uint32_t make_leaf(const Range& range) {
        const Record* records = w_.records[range.buffer];
        for (uint32_t i = range.begin; i < range.end; ++i) w_.leaves[i] = records[i].ref();
        ++result.leaves;
        result.depth = std::max(result.depth, range.depth);
        return BVH2_MAKE_LEAF(range.begin, range.count());
    }

    const Workspace& w_;
    bvh2_node* const nodes_;
    Bins bins_;
};

}  // namespace

Subtree build_subtree(const Workspace& workspace, const Range& range) {
    Builder builder(workspace, range);
    builder.result.root = builder.build(range);
    return builder.result;
}

}  // namespace bvh2
