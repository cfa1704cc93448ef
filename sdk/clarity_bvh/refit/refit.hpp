// refit.hpp -- refits trees from the leaves up, on all cores, for any layout whose subtrees stand together.
//
// The limit is memory: a node is read and written once, and the boxes of primitives come from the host just before they are
// used. So the tree is cut into subtrees of some hundred nodes. Their nodes, primitives and boxes stay in a core's own cache
// while they are swept backwards, children before parents. No thread waits for another: what is above the subtrees of the
// threads is a few nodes, which the calling thread does in the end.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "clarity_bvh/base/vec4.hpp"
#include "rt_plugin.hpp"

namespace clarity::bvh {

// What a refit knows of a subtree: its box, and the sums of areas that its cost is made of.

// An axis-aligned box. The fourth lanes hold anything. A new one is empty.
struct RefitBox {
    Vec4 lo = splat(FLT_MAX), hi = splat(-FLT_MAX);
    void add(const RefitBox& other) {
        lo = min(lo, other.lo);
        hi = max(hi, other.hi);
    }
    void add(const rt_prim& prim) {
        lo = min(lo, load_any(prim.lo));
        hi = max(hi, load_any(prim.hi));
    }
    bool empty() const {
        alignas(16) float low[4], high[4];
        store(low, lo);
        store(high, hi);
        return low[0] > high[0];
    }
    // Writes lo.xyz, hi.xyz and leaves the number behind them as it is.
    void write(float box[7]) const {
        const float behind = box[6];
        store_any(box, lo);
        store_any(box + 3, hi);
        box[6] = behind;
    }
};

// Areas of nodes and of primitives (leaf boxes times their numbers of primitives) in some unit. Lane by lane: x y, y z and z x.
struct RefitAreas {
    Vec4 nodes = splat(0.0f), primitives = splat(0.0f);
};

// The unit of areas in a group: the square of a length, so that they neither overflow for huge coordinates nor vanish for tiny
// ones. per_length: 1 by that length, as unit_scale() gives it; of a box without extent 1 is taken.
struct RefitUnit {
    explicit RefitUnit(float per_length = 1) : per_side(splat(per_length < FLT_MAX ? per_length : 1)) {}
    Vec4 per_side;
    Vec4 area(const RefitBox& box) const {
        const Vec4 side = xyz(box.hi - box.lo) * per_side;  // the fourth lanes may be denormals, which are slow to multiply
        return side * turned(side);
    }

 private:
    // (y, z, x, 0)
    static Vec4 turned(Vec4 a) {
#ifdef CLARITY_BVH_SSE2
        return {_mm_shuffle_ps(a.m, a.m, _MM_SHUFFLE(3, 0, 2, 1))};
#else
        return {{a.v[1], a.v[2], a.v[0], a.v[3]}};
#endif
    }
};

// Half the area whose products of sides are these lanes.
inline double sum_of(Vec4 products) {
    alignas(16) float lanes[4];
    store(lanes, products);
    return double{lanes[0]} + lanes[1] + lanes[2];
}

// A node and its descendants, which are the nodes first .. end - 1. A child has a greater index than its parent.
struct RefitSubtree {
    uint32_t node, first, end;
    uint32_t size() const { return end - first + 1; }
};

// The costs of a tree to a ray, by the surface area heuristic.
struct RefitCosts {
    double node, primitive;
};

// clang-format off
// Layout has:
//   kWidth                            most children of a node
//   kBlock                            nodes of a subtree that one sweep takes
//   subtrees(group, each)             calls each(RefitSubtree) for the trees of a group, in any order
//   children(subtree, RefitSubtree out[kWidth])   writes the children that are nodes, ascending, and returns their number
//   add_positions(node, first, end)   widens the range of positions in leaf order by those of the node's own leaves; returns their
//                                     number
//   update(node, node_box, leaf_box, unit, areas)   writes the boxes of the node's children, adds their areas, and returns the box
//                                     around them. node_box(child) and leaf_box(first, count) give the boxes of its children
//   finish(group, box)                writes what stands above the trees of a group
//   unit(group)                       RefitUnit of a group, from its boxes before the refit
// clang-format on
template <class Layout>
class Refit {
 public:
    Refit(const rt_host* host, const rt_refit_input* in, const rt_refit_output* out, Layout& layout, const RefitCosts& costs)
        : host_(host), in_(in), out_(out), layout_(layout), costs_(costs) {}

    void run() {
        for (uint32_t g = 0; g < in_->group_count; ++g) {
            if (!in_->changed[g]) continue;
            const RefitUnit unit = layout_.unit(g);
            layout_.subtrees(g, [&](const RefitSubtree& tree) { plan(tree, unit); });
        }
        rt::parallel_for(host_, static_cast<rt_u32>(jobs_.size()), [&](rt_u32 j) {
            rt::progress(host_, 0.5f);  // only to notice that the user cancelled
            Worker worker(jobs_[j].unit);
            jobs_[j].box = sweep(jobs_[j].tree, worker);
            jobs_[j].node_area = sum_of(worker.areas.nodes);
            jobs_[j].primitive_area = sum_of(worker.areas.primitives);
        });
        size_t next = 0;
        for (uint32_t g = 0; g < in_->group_count; ++g)
            if (in_->changed[g]) finish_group(g, next);
    }

 private:
    // Nodes of a subtree that one thread takes: many enough that the loop over them costs nothing.
    static constexpr uint32_t kJob = 4096;
    static constexpr uint32_t kPrims = 1024;  // primitives of a block, at most

    struct Job {
        RefitSubtree tree;
        RefitUnit unit;
        RefitBox box;
        double node_area = 0, primitive_area = 0;
    };
    struct Worker {
        explicit Worker(const RefitUnit& unit) : unit(unit) {}
        rt_prim prims[kPrims];
        RefitBox boxes[Layout::kBlock];
        RefitUnit unit;
        RefitAreas areas;
    };

    void plan(const RefitSubtree& tree, const RefitUnit& unit) {
        if (tree.size() <= kJob) {
            jobs_.push_back({tree, unit, {}});
            return;
        }
        RefitSubtree children[Layout::kWidth];
        const uint32_t count = layout_.children(tree, children);
        for (uint32_t i = 0; i < count; ++i) plan(children[i], unit);
    }

    // Calls below(child) for each child that is a node, and writes the node.
    template <class Below>
    RefitBox update_above(const RefitSubtree& tree, const RefitUnit& unit, RefitAreas& areas, rt_prim* prims, Below&& below) {
        RefitSubtree children[Layout::kWidth];
        RefitBox boxes[Layout::kWidth];
        const uint32_t count = layout_.children(tree, children);
        for (uint32_t i = 0; i < count; ++i) boxes[i] = below(children[i]);
        const auto node_box = [&](uint32_t child) -> const RefitBox& {
            uint32_t i = 0;
            while (children[i].node != child) ++i;
            return boxes[i];
        };
        const auto leaf_box = [&](uint64_t first, uint64_t leaf_size) {
            RefitBox box;
            for (uint64_t done = 0; done < leaf_size; done += kPrims) {
                const uint64_t piece = std::min<uint64_t>(leaf_size - done, kPrims);
                rt::prims(in_, first + done, piece, prims);
                for (uint64_t i = 0; i < piece; ++i) box.add(prims[i]);
            }
            return box;
        };
        return layout_.update(tree.node, node_box, leaf_box, unit, areas);
    }

    RefitBox sweep(const RefitSubtree& tree, Worker& worker) {
        if (tree.size() <= Layout::kBlock) {
            uint64_t first = ~uint64_t{0}, end = 0;
            uint64_t count = layout_.add_positions(tree.node, first, end);
            for (uint32_t at = tree.first; at < tree.end; ++at) count += layout_.add_positions(at, first, end);
            if (count == 0) first = end;
            // Positions between those of the subtree would belong to another one.
            if (count <= kPrims && end - first == count) return sweep_block(tree, worker, first, end);
        }
        return update_above(tree, worker.unit, worker.areas, worker.prims,
                            [&](const RefitSubtree& child) { return sweep(child, worker); });
    }

    RefitBox sweep_block(const RefitSubtree& tree, Worker& worker, uint64_t first, uint64_t end) {
        if (first < end) rt::prims(in_, first, end - first, worker.prims);
        const auto node_box = [&](uint32_t child) -> const RefitBox& { return worker.boxes[child - tree.first]; };
        const auto leaf_box = [&](uint64_t at, uint64_t count) {
            const rt_prim* const prims = worker.prims + (at - first);
            RefitBox box{load_any(prims->lo), load_any(prims->hi)};
            for (uint64_t i = 1; i < count; ++i) box.add(prims[i]);
            return box;
        };
        for (uint32_t at = tree.end; at-- > tree.first;)
            worker.boxes[at - tree.first] = layout_.update(at, node_box, leaf_box, worker.unit, worker.areas);
        return layout_.update(tree.node, node_box, leaf_box, worker.unit, worker.areas);
    }

    // The nodes above the jobs, in the order of plan().
    RefitBox finish_tree(const RefitSubtree& tree, const RefitUnit& unit, RefitAreas& areas, size_t& next, double sums[2]) {
        if (tree.size() <= kJob) {
            const Job& job = jobs_[next++];
            sums[0] += job.node_area;
            sums[1] += job.primitive_area;
            return job.box;
        }
        return update_above(tree, unit, areas, top_prims_,
                            [&](const RefitSubtree& child) { return finish_tree(child, unit, areas, next, sums); });
    }

    void finish_group(uint32_t group, size_t& next) {
        const RefitUnit unit = next < jobs_.size() ? jobs_[next].unit : RefitUnit{};
        RefitAreas areas;
        RefitBox box;
        double sums[2] = {0, 0};
        layout_.subtrees(group, [&](const RefitSubtree& tree) { box.add(finish_tree(tree, unit, areas, next, sums)); });
        layout_.finish(group, box);
        sums[0] += sum_of(areas.nodes);
        sums[1] += sum_of(areas.primitives);
        const double whole = box.empty() ? 0 : sum_of(unit.area(box));
        const double sum = costs_.node * (whole + sums[0]) + costs_.primitive * sums[1], cost = whole > 0 ? sum / whole : 0;
        // Areas overflow if a group has grown by more than 10^19 at once: then the cost is not known.
        if (out_->cost && std::isfinite(cost)) out_->cost(out_->ctx, group, cost);
    }

    const rt_host* const host_;
    const rt_refit_input* const in_;
    const rt_refit_output* const out_;
    Layout& layout_;
    const RefitCosts costs_;
    std::vector<Job> jobs_;
    rt_prim top_prims_[kPrims];
};

// Where the nodes of each group end, if they stand together, group by group: the first node of the next group. roots: in any
// order.
class GroupEnds {
 public:
    GroupEnds(const rt_refit_input* in, uint64_t node_count) : end_(static_cast<uint32_t>(node_count)) {
        if (in->group_count < 2) return;
        roots_.assign(in->roots, in->roots + in->group_count);
        if (!std::is_sorted(roots_.begin(), roots_.end())) std::sort(roots_.begin(), roots_.end());
    }
    uint32_t end_of(uint32_t root) const {
        const auto next = std::upper_bound(roots_.begin(), roots_.end(), root);
        return next == roots_.end() ? end_ : *next;
    }

 private:
    const uint32_t end_;
    std::vector<uint32_t> roots_;
};

}  // namespace clarity::bvh
