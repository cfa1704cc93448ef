#include "clarity_bvh/wide/wide_morton.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>

#include "clarity_bvh/build/sorted_run.hpp"
#include "rt_plugin.hpp"

namespace clarity::bvh {
namespace {

// Work memory of a thread for one run at a time.
struct RunSpace {
    explicit RunSpace(uint32_t size) : nodes(size), root_costs(size) {}
    Scratch<Node> nodes;
    Scratch<RootCosts> root_costs;
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

template <uint32_t Width>
class WideMorton<Width>::RunBuilder {
 public:
    RunBuilder(const RunSpace& space, const WideLayout<Width>& layout, const Costs& costs, uint32_t run, Finished& result)
        : nodes_(space.nodes.data()),
          root_costs_(space.root_costs.data()),
          collapse_(nodes_, root_costs_, costs),
          layout_(layout),
          max_leaf_(costs.max_leaf),
          run_(run),
          result_(result) {}

    // Builds the subtree of the run. `whole` means that the run is a whole group, with no nodes above it.
    void build(const MortonOrder& order, uint32_t* refs, bool whole, float scale) {
        const MortonOrder::Run& run = order.runs()[run_];
        uint32_t count = 0;
        const SortedSubtree root =
            sweep(order.sort(run), run.count(), order.prims(run.group), run.begin, max_leaf_, refs + run.begin, nodes_, count);
        store(result_.box.lo, root.lo);
        store(result_.box.neg_hi, root.neg_hi);
        result_.root = root.code;
        if (count == 0) return;
        for (uint32_t i = 0; i < count; ++i) collapse_.decide(i, scale, 0);
        result_.nodes.reserve(count / 3 + 1);
        if (whole) {
            result_.root = finish(root.code);
        } else {
            slot_count_ = collapse_.children(root.code, slots_);
            result_.root = keep(root.code);
        }
    }

 private:
    uint32_t finish(uint32_t binary) {
        Branch part{run_, static_cast<uint32_t>(result_.nodes.size()), {}, {}, root_costs_[binary].cost[0]};
        part.extent = write(binary, part.first, part.sums);
        result_.parts.push_back(part);
        return static_cast<uint32_t>(result_.parts.size() - 1) | kPart;
    }

    // Writes the wide nodes below a binary node. Child indices count from the part's first node.
    WideExtent write(uint32_t binary, uint32_t first, WideSums& sums) {
        Slot slots[Width];
        const uint32_t count = collapse_.children(binary, slots);
        const size_t at = result_.nodes.size();
        result_.nodes.emplace_back();
        sums.add(slots, count);
        WideExtent extent;
        extent.stack = count;
        uint32_t below[Width];
        for (uint32_t i = 0; i < count; ++i) {
            below[i] = slots[i].leaf;
            if (slots[i].leaf != kEmpty) continue;
            below[i] = static_cast<uint32_t>(result_.nodes.size()) - first;
            extent.add(write(slots[i].binary, first, sums), count - 1);
        }
        layout_.write(result_.nodes[at], slots, below, count);
        return extent;
    }

    // Copies the binary nodes that the root merges, and finishes the subtrees below them. Returns the index in `upper`.
    uint32_t keep(uint32_t binary) {
        const auto index = static_cast<uint32_t>(result_.upper.size());
        Node node = nodes_[binary];
        result_.upper.push_back(node);
        for (uint32_t* child : {&node.child0, &node.child1}) {
            if (is_leaf(*child)) continue;
            const bool becomes_node = std::any_of(
                slots_, slots_ + slot_count_, [&](const Slot& slot) { return slot.leaf == kEmpty && slot.binary == *child; });
            *child = becomes_node ? finish(*child) : keep(*child);
        }
        result_.upper[index] = node;
        return index;
    }

    Node* const nodes_;
    RootCosts* const root_costs_;
    const Collapse<Width> collapse_;
    const WideLayout<Width>& layout_;
    const uint32_t max_leaf_;
    const uint32_t run_;
    Finished& result_;
    Slot slots_[Width];  // of the run's root
    uint32_t slot_count_ = 0;
};

template <uint32_t Width>
uint64_t WideMorton<Width>::bytes(uint64_t primitive_count) {
    return MortonOrder::bytes(primitive_count) + primitive_count * sizeof(WideNode<Width>) / 16;
}

template <uint32_t Width>
WideMorton<Width>::WideMorton(const rt_host* host, const rt_build_input& input, const RefMemory& refs_of,
                              const WideLayout<Width>& layout, const Costs& costs, uint64_t primitive_count, float share)
    : layout_(layout) {
    uint32_t* const refs = refs_of(primitive_count);
    const MortonOrder order(host, input, primitive_count);
    rt::progress(host, share / 2);
    const std::vector<MortonOrder::Run>& runs = order.runs();
    uint32_t largest = 0;
    for (const MortonOrder::Run& run : runs) largest = std::max(largest, run.count());
    RunSpaces spaces(largest);
    std::atomic<uint64_t> done{0};
    runs_.resize(runs.size());
    rt::parallel_for(host, static_cast<rt_u32>(runs.size()), [&](uint32_t r) {
        std::unique_ptr<RunSpace> space = spaces.take();
        const MortonOrder::Group& group = order.groups()[runs[r].group];
        RunBuilder(*space, layout_, costs, r, runs_[r])
            .build(order, refs, group.code & MortonOrder::kRun, unit_scale(group.box));
        spaces.give(std::move(space));
        const double share_done = static_cast<double>(done += runs[r].count()) / static_cast<double>(primitive_count);
        rt::progress(host, share * static_cast<float>(0.5 + 0.5 * share_done));
    });
    join(order, costs);
}

// Joins the runs. Order of nodes_: tops, the nodes that the runs keep, parts. So children come after their parents.
template <uint32_t Width>
void WideMorton<Width>::join(const MortonOrder& order, const Costs& costs) {
    const auto top_count = static_cast<uint32_t>(order.tops().size());
    std::vector<uint32_t> first_upper;
    first_part_ = top_count;
    for (const Finished& run : runs_) {
        first_upper.push_back(first_part_);
        first_part_ += static_cast<uint32_t>(run.upper.size());
    }
    nodes_.resize(top_count);
    nodes_.reserve(first_part_);
    std::vector<uint32_t> code_of_run;
    std::vector<uint32_t> groups(top_count);
    for (uint32_t r = 0; r < runs_.size(); ++r) {
        const auto first_part = first_part_ + static_cast<uint32_t>(parts_.size());
        const auto joined = [&](uint32_t code) {
            if (is_leaf(code)) return code;
            return code & kPart ? first_part + (code & ~kPart) : first_upper[r] + code;
        };
        for (Node node : runs_[r].upper) {
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
    for (size_t p = 0; p < parts_.size(); ++p) std::fill_n(root_costs_[first_part_ + p].cost, kRoots, parts_[p].cost);

    std::vector<Bounds> boxes(top_count);
    const auto code_of = [&](uint32_t code) {
        return code & MortonOrder::kRun ? code_of_run[code & ~MortonOrder::kRun] : code;
    };
    for (uint32_t t = top_count; t-- > 0;) {
        const MortonOrder::Top& top = order.tops()[t];
        groups[t] = top.group;
        for (int c = 0; c < 2; ++c) {
            const uint32_t child = top.child[c];
            const Bounds& box = child & MortonOrder::kRun ? runs_[child & ~MortonOrder::kRun].box : boxes[child];
            set_child(nodes_[t], c, box, code_of(child));
            boxes[t].add(box);
        }
    }
    collapse_ = std::make_unique<const Collapse<Width>>(nodes_.data(), root_costs_.data(), costs);
    for (uint32_t i = first_part_; i-- > 0;) collapse_->decide(i, unit_scale(order.groups()[groups[i]].box), Decision::kIsTop);
    for (const MortonOrder::Group& group : order.groups()) {
        Root root{group.box, RT_NONE};
        if (group.code != RT_NONE) root.code = code_of(group.code);
        roots_.push_back(root);
    }
}

template <uint32_t Width>
void WideMorton<Width>::write(uint32_t binary, WideNode<Width>* nodes, uint32_t at, WideSums& sums) const {
    const Branch& part = of_binary(binary);
    sums.add(part.sums);
    for (uint32_t i = 0; i < part.extent.nodes; ++i) {
        WideNode<Width> node = runs_[part.run].nodes[part.first + i];
        for (uint32_t& child : node.child)
            if (!is_leaf(child)) child += at;
        nodes[at + i] = node;
        if (layout_.settle) layout_.settle(nodes, at + i);
    }
}

template class WideMorton<4>;
template class WideMorton<8>;

}  // namespace clarity::bvh
