#include "morton_tree.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>

#include "node_memory.hpp"
#include "node_slots.hpp"
#include "rt_plugin.hpp"
#include "sorted_run.hpp"

namespace bvh8 {
namespace {

using bvh2::MortonOrder;

// Work memory of a thread for one run at a time.
struct RunSpace {
    explicit RunSpace(uint32_t size) : nodes(size), root_costs(size) {}
    bvh2::Scratch<bvh2_node> nodes;
    bvh2::Scratch<RootCosts> root_costs;
};

// A pool of work memories. It grows to the number of threads that work at the same time.
class RunSpaces {
 public:
    explicit RunSpaces(uint32_t size) : size_(size) {}
    std::unique_ptr<RunSpace> take() {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            if (!free_.empty()) {
                std::unique_ptr<RunSpace> space = std::move(free_.back());
                free_.pop_back();
                return space;
            }
        }
        return std::make_unique<RunSpace>(size_);
    }
    void give(std::unique_ptr<RunSpace> space) {
        const std::lock_guard<std::mutex> lock(mutex_);
        free_.push_back(std::move(space));
    }

 private:
    const uint32_t size_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<RunSpace>> free_;
};

}  // namespace

class MortonTree::RunBuilder {
 public:
    RunBuilder(const RunSpace& space, const Costs& costs, rt_u32 run, Finished& result)
        : nodes_(space.nodes.data()),
          root_costs_(space.root_costs.data()),
          collapse_(nodes_, root_costs_, costs),
          max_leaf_(costs.max_leaf),
          run_(run),
          result_(result) {}

    // Builds the subtree of the run. `whole` means that the run is a whole group, with no nodes above it.
    void build(const MortonOrder& order, rt_u32* refs, bool whole, float scale) {
        const MortonOrder::Run& run = order.runs()[run_];
        uint32_t count = 0;
        const bvh2::SortedSubtree root = bvh2::sweep(order.sort(run), run.count(), order.prims(run.group), run.begin, max_leaf_,
                                                     refs + run.begin, nodes_, count);
        bvh2::store(result_.box.lo, root.lo);
        bvh2::store(result_.box.neg_hi, root.neg_hi);
        result_.root = root.code;
        if (count == 0) return;
        for (rt_u32 i = 0; i < count; ++i) collapse_.decide(i, scale, 0);
        result_.nodes.reserve(count / 3 + 1);
        if (whole) {
            result_.root = finish(root.code);
        } else {
            slot_count_ = collapse_.children(root.code, slots_);
            result_.root = keep(root.code);
        }
    }

 private:
    rt_u32 finish(rt_u32 binary) {
        Part part{run_, static_cast<rt_u32>(result_.nodes.size()), {}, {}, root_costs_[binary].cost[0]};
        part.extent = write(binary, part.first, part.sums);
        result_.parts.push_back(part);
        return static_cast<rt_u32>(result_.parts.size() - 1) | kPart;
    }

    // Writes the wide nodes below a binary node. Child indices count from the part's first node.
    Extent write(rt_u32 binary, rt_u32 first, Sums& sums) {
        Slot slots[BVH8_WIDTH];
        const uint32_t count = collapse_.children(binary, slots);
        const size_t at = result_.nodes.size();
        result_.nodes.emplace_back();
        sums.add(slots, count);
        Extent extent;
        extent.stack = count;
        rt_u32 below[BVH8_WIDTH];
        for (uint32_t i = 0; i < count; ++i) {
            below[i] = slots[i].leaf;
            if (slots[i].leaf != BVH8_EMPTY) continue;
            below[i] = static_cast<rt_u32>(result_.nodes.size()) - first;
            extent.add(write(slots[i].binary, first, sums), count - 1);
        }
        write_node(result_.nodes[at], slots, below, count);
        return extent;
    }

    // Copies the binary nodes that the root merges, and finishes the subtrees below them. Returns the index in `upper`.
    rt_u32 keep(rt_u32 binary) {
        const auto index = static_cast<rt_u32>(result_.upper.size());
        bvh2_node node = nodes_[binary];
        result_.upper.push_back(node);
        for (rt_u32* child : {&node.child0, &node.child1}) {
            if (*child & BVH2_LEAF) continue;
            const bool becomes_node = std::any_of(slots_, slots_ + slot_count_, [&](const Slot& slot) {
                return slot.leaf == BVH8_EMPTY && slot.binary == *child;
            });
            *child = becomes_node ? finish(*child) : keep(*child);
        }
        result_.upper[index] = node;
        return index;
    }

    bvh2_node* const nodes_;
    RootCosts* const root_costs_;
    const Collapse collapse_;
    const uint32_t max_leaf_;
    const rt_u32 run_;
    Finished& result_;
    Slot slots_[BVH8_WIDTH];  // of the run's root
    uint32_t slot_count_ = 0;
};

uint64_t MortonTree::bytes(uint64_t primitive_count) {
    return MortonOrder::bytes(primitive_count) + primitive_count * sizeof(bvh8_node) / 16;
}

MortonTree::MortonTree(const rt_host* host, const rt_build_input& input, const rt_build_output* out, const Costs& costs,
                       uint64_t primitive_count, float share) {
    rt_u32* const refs = rt::leaves(out, primitive_count);
    const MortonOrder order(host, input, primitive_count);
    rt::progress(host, share / 2);
    const std::vector<MortonOrder::Run>& runs = order.runs();
    uint32_t largest = 0;
    for (const MortonOrder::Run& run : runs) largest = std::max(largest, run.count());
    RunSpaces spaces(largest);
    std::atomic<uint64_t> done{0};
    runs_.resize(runs.size());
    rt::parallel_for(host, static_cast<rt_u32>(runs.size()), [&](rt_u32 r) {
        std::unique_ptr<RunSpace> space = spaces.take();
        const MortonOrder::Group& group = order.groups()[runs[r].group];
        RunBuilder(*space, costs, r, runs_[r]).build(order, refs, group.code & MortonOrder::kRun, bvh2::unit_scale(group.box));
        spaces.give(std::move(space));
        const double share_done = static_cast<double>(done += runs[r].count()) / static_cast<double>(primitive_count);
        rt::progress(host, share * static_cast<float>(0.5 + 0.5 * share_done));
    });
    join(order, costs);
}

// Joins the runs. Order of nodes_: tops, the nodes that the runs keep, parts. So children come after their parents.
void MortonTree::join(const MortonOrder& order, const Costs& costs) {
    const auto top_count = static_cast<rt_u32>(order.tops().size());
    std::vector<rt_u32> first_upper;
    first_part_ = top_count;
    for (const Finished& run : runs_) {
        first_upper.push_back(first_part_);
        first_part_ += static_cast<rt_u32>(run.upper.size());
    }
    nodes_.resize(top_count);
    nodes_.reserve(first_part_);
    std::vector<rt_u32> code_of_run;
    std::vector<rt_u32> groups(top_count);
    for (rt_u32 r = 0; r < runs_.size(); ++r) {
        const auto first_part = first_part_ + static_cast<rt_u32>(parts_.size());
        const auto joined = [&](rt_u32 code) {
            if (code & BVH2_LEAF) return code;
            return code & kPart ? first_part + (code & ~kPart) : first_upper[r] + code;
        };
        for (bvh2_node node : runs_[r].upper) {
            node.child0 = joined(node.child0);
            node.child1 = joined(node.child1);
            nodes_.push_back(node);
            groups.push_back(order.runs()[r].group);
        }
        parts_.insert(parts_.end(), runs_[r].parts.begin(), runs_[r].parts.end());
        code_of_run.push_back(joined(runs_[r].root));
    }
    nodes_.resize(first_part_ + parts_.size());  // a part's node is no leaf and always one root
    root_costs_.resize(nodes_.size());
    for (size_t p = 0; p < parts_.size(); ++p) std::fill_n(root_costs_[first_part_ + p].cost, bvh2::kRoots, parts_[p].cost);

    std::vector<bvh2::Bounds> boxes(top_count);
    const auto code_of = [&](rt_u32 code) { return code & MortonOrder::kRun ? code_of_run[code & ~MortonOrder::kRun] : code; };
    for (rt_u32 t = top_count; t-- > 0;) {
        const MortonOrder::Top& top = order.tops()[t];
        groups[t] = top.group;
        for (int c = 0; c < 2; ++c) {
            const rt_u32 child = top.child[c];
            const bvh2::Bounds& box = child & MortonOrder::kRun ? runs_[child & ~MortonOrder::kRun].box : boxes[child];
            bvh2::set_child(nodes_[t], c, box, code_of(child));
            boxes[t].add(box);
        }
    }
    collapse_ = std::make_unique<const Collapse>(nodes_.data(), root_costs_.data(), costs);
    for (rt_u32 i = first_part_; i-- > 0;)
        collapse_->decide(i, bvh2::unit_scale(order.groups()[groups[i]].box), Decision::kIsTop);
    for (const MortonOrder::Group& group : order.groups()) {
        bvh2::Root root{group.box, RT_NONE};
        if (group.code != RT_NONE) root.code = code_of(group.code);
        roots_.push_back(root);
    }
}

void MortonTree::write(rt_u32 binary, bvh8_node* nodes, rt_u32 at, Sums& sums) const {
    const Part& part = of_binary(binary);
    sums.add(part.sums);
    for (rt_u32 i = 0; i < part.extent.nodes; ++i) {
        bvh8_node node = runs_[part.run].nodes[part.first + i];
        for (rt_u32& child : node.child)
            if (!(child & BVH8_LEAF)) child += at;
        nodes[at + i] = node;
        settle(nodes, at + i);
    }
}

}  // namespace bvh8
