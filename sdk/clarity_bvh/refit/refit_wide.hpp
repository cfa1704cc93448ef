// refit_wide.hpp -- refits wide nodes with whole boxes in depth-first order, as wide_tree.hpp writes them.
//
// Work for a triangle: about 0.05 nodes of eight children or 0.15 of four are read and written, 11 or 20 bytes each way,
// besides what the host moves.
#pragma once
#include "clarity_bvh/refit/refit.hpp"
#include "clarity_bvh/topology.hpp"

namespace clarity::bvh {

// Rows tells where the numbers of a node are:
//   kWidth, kBlock
//   plane(at, k)      the row of a bound: k = 0..2 lower ones in x, y, z, k = 3..5 upper ones
//   child(at, slot)   the code of a child as topology.hpp has it
template <class Rows>
class WideRefit {
 public:
    static constexpr uint32_t kWidth = Rows::kWidth, kBlock = Rows::kBlock;

    WideRefit(const Rows& rows, uint64_t node_count, const rt_refit_input* in) : rows_(rows), ends_(in, node_count), in_(in) {}

    RefitUnit unit(uint32_t group) const {
        Bounds box;
        bool any = false;
        for (uint32_t slot = 0; slot < kWidth; ++slot) {
            if (rows_.child(in_->roots[group], slot) == kEmpty) continue;
            float bounds[6];
            for (uint32_t k = 0; k < 6; ++k) bounds[k] = rows_.plane(in_->roots[group], k)[slot];
            box.add(bounds, bounds + 3);
            any = true;
        }
        return RefitUnit(any ? unit_scale(box) : 1);
    }
    template <class Each>
    void subtrees(uint32_t group, Each&& each) const {
        const uint32_t root = in_->roots[group];
        each(RefitSubtree{root, root + 1, ends_.end_of(root)});
    }
    uint32_t children(const RefitSubtree& tree, RefitSubtree out[kWidth]) const {
        uint32_t count = 0;
        for (uint32_t slot = 0; slot < kWidth; ++slot) {
            const uint32_t child = rows_.child(tree.node, slot);
            if (is_leaf(child)) continue;
            uint32_t i = count++;
            for (; i > 0 && out[i - 1].node > child; --i) out[i] = out[i - 1];
            out[i] = {child, child + 1, 0};
        }
        for (uint32_t i = 0; i < count; ++i) out[i].end = i + 1 < count ? out[i + 1].node : tree.end;
        return count;
    }
    uint64_t add_positions(uint32_t at, uint64_t& first, uint64_t& end) const {
        uint64_t count = 0;
        for (uint32_t slot = 0; slot < kWidth; ++slot) {
            const uint32_t child = rows_.child(at, slot);
            if (!is_leaf(child) || child == kEmpty) continue;
            first = std::min<uint64_t>(first, leaf_first(child));
            end = std::max<uint64_t>(end, leaf_first(child) + leaf_count(child));
            count += leaf_count(child);
        }
        return count;
    }
    template <class NodeBox, class LeafBox>
    RefitBox update(uint32_t at, NodeBox&& node_box, LeafBox&& leaf_box, const RefitUnit& unit, RefitAreas& areas) const {
        RefitBox whole;
        for (uint32_t slot = 0; slot < kWidth; ++slot) {
            const uint32_t child = rows_.child(at, slot);
            if (child == kEmpty) continue;
            RefitBox fresh;
            if (is_leaf(child)) {
                const uint32_t count = leaf_count(child);
                fresh = leaf_box(leaf_first(child), count);
                areas.primitives = areas.primitives + unit.area(fresh) * splat(static_cast<float>(count));
            } else {
                fresh = node_box(child);
                areas.nodes = areas.nodes + unit.area(fresh);
            }
            whole.add(fresh);
            alignas(16) float bounds[8];
            store(bounds, fresh.lo);
            store(bounds + 4, fresh.hi);
            for (uint32_t k = 0; k < 3; ++k) {
                rows_.plane(at, k)[slot] = bounds[k];
                rows_.plane(at, 3 + k)[slot] = bounds[4 + k];
            }
        }
        return whole;
    }
    void finish(uint32_t, const RefitBox&) const {}

 private:
    const Rows rows_;
    const GroupEnds ends_;
    const rt_refit_input* const in_;
};

}  // namespace clarity::bvh
