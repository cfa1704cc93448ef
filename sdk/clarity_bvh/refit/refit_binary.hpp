// refit_binary.hpp -- refits binary nodes in depth-first order, as pack_binary.hpp writes them. A plugin's node must have the
// layout of Node.
//
// Work for a triangle with leaves of four: about 0.6 nodes are read and written, 64 bytes each way, besides what the host
// moves.
#pragma once
#include "clarity_bvh/refit/refit.hpp"
#include "clarity_bvh/topology.hpp"

namespace clarity::bvh {

class BinaryRefit {
 public:
    static constexpr uint32_t kWidth = 2, kBlock = 256;

    BinaryRefit(Node* nodes, uint64_t node_count, const rt_refit_input* in) : nodes_(nodes), ends_(in, node_count), in_(in) {}

    RefitUnit unit(uint32_t group) const {
        const Node& root = nodes_[in_->roots[group]];
        Bounds box;
        if (root.child0 != kEmpty) box.add(root.box0, root.box0 + 3);
        if (root.child1 != kEmpty) box.add(root.box1, root.box1 + 3);
        return RefitUnit(root.child0 == kEmpty ? 1 : unit_scale(box));
    }
    template <class Each>
    void subtrees(uint32_t group, Each&& each) const {
        const uint32_t root = in_->roots[group];
        each(RefitSubtree{root, root + 1, ends_.end_of(root)});
    }
    uint32_t children(const RefitSubtree& tree, RefitSubtree out[kWidth]) const {
        const Node& node = nodes_[tree.node];
        uint32_t count = 0;
        if (!is_leaf(node.child0)) out[count++] = {node.child0, node.child0 + 1, is_leaf(node.child1) ? tree.end : node.child1};
        if (!is_leaf(node.child1)) out[count++] = {node.child1, node.child1 + 1, tree.end};
        return count;
    }
    uint64_t add_positions(uint32_t at, uint64_t& first, uint64_t& end) const {
        uint64_t count = 0;
        for (const uint32_t child : {nodes_[at].child0, nodes_[at].child1}) {
            if (!is_leaf(child) || child == kEmpty) continue;
            first = std::min<uint64_t>(first, leaf_first(child));
            end = std::max<uint64_t>(end, leaf_first(child) + leaf_count(child));
            count += leaf_count(child);
        }
        return count;
    }
    template <class NodeBox, class LeafBox>
    RefitBox update(uint32_t at, NodeBox&& node_box, LeafBox&& leaf_box, const RefitUnit& unit, RefitAreas& areas) const {
        Node& node = nodes_[at];
        RefitBox whole;
        const auto one = [&](float* box, uint32_t child) {
            if (child == kEmpty) return;
            RefitBox fresh;
            if (is_leaf(child)) {
                const uint32_t count = leaf_count(child);
                fresh = leaf_box(leaf_first(child), count);
                areas.primitives = areas.primitives + unit.area(fresh) * splat(static_cast<float>(count));
            } else {
                fresh = node_box(child);
                areas.nodes = areas.nodes + unit.area(fresh);
            }
            fresh.write(box);
            whole.add(fresh);
        };
        one(node.box0, node.child0);
        one(node.box1, node.child1);
        return whole;
    }
    void finish(uint32_t, const RefitBox&) const {}

 private:
    Node* const nodes_;
    const GroupEnds ends_;
    const rt_refit_input* const in_;
};

}  // namespace clarity::bvh
