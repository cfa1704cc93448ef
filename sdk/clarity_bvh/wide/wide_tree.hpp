// wide_tree.hpp -- writes the nodes of the wide tree on all cores, as Collapse has decided them.
#pragma once
#include <array>
#include <functional>
#include <vector>

#include "clarity_bvh/wide/collapse.hpp"

namespace clarity::bvh {

// Statistics of a finished tree, collected while its nodes are written.
struct WideStatistics {
    uint64_t leaves = 0, children = 0;
    rt::ExpectedCost expected;
    double sah_cost = 0;  // as Quality::sah_cost, for nodes of any number of children
};

// Sums over the children of some nodes.
struct WideSums {
    uint64_t leaves = 0, children = 0;
    rt::Surfaces surfaces{};
    void add(const Slot* slots, uint32_t count);
    void add(const WideSums& other);
};

// The size of a subtree; see WideTree for the members.
struct WideExtent {
    uint32_t nodes = 1;
    uint32_t depth = 1, stack = 0;
    void add(const WideExtent& child, uint32_t siblings);
};

// The subtrees of the wide tree that single threads count and write. Each is identified by the binary node that it was made
// from. All functions may be called from any thread.
template <uint32_t Width>
class WideSubtrees {
 public:
    virtual ~WideSubtrees() = default;
    virtual WideExtent measure(uint32_t binary) const = 0;
    virtual bool measured() const { return false; }  // true: measure() costs nothing
    // Writes the subtree depth-first from nodes[at] on, and adds its sums to `sums`.
    virtual void write(uint32_t binary, WideNode<Width>* nodes, uint32_t at, WideSums& sums) const = 0;
};

// Subtrees that are written from a topology which still exists.
template <uint32_t Width>
class CollapsedSubtrees : public WideSubtrees<Width> {
 public:
    // The arguments must outlive this object.
    CollapsedSubtrees(const Collapse<Width>& collapse, const WideLayout<Width>& layout)
        : collapse_(collapse), layout_(layout) {}
    WideExtent measure(uint32_t binary) const override;
    void write(uint32_t binary, WideNode<Width>* nodes, uint32_t at, WideSums& sums) const override {
        write_subtree(binary, nodes, at, sums);
    }

 private:
    uint32_t write_subtree(uint32_t binary, WideNode<Width>* nodes, uint32_t at, WideSums& sums) const;
    const Collapse<Width>& collapse_;
    const WideLayout<Width>& layout_;
};

// Where a packer writes. The functions are called on the calling thread.
template <uint32_t Width>
struct WideOutput {
    std::function<WideNode<Width>*(uint64_t count)> nodes;    // gives memory for all nodes; called once
    std::function<void(uint32_t group, uint32_t node)> root;  // reports the root of each group
};

template <uint32_t Width>
class WideTree {
 public:
    // Nodes above the parts come from `collapse`, nodes below from `subtrees`. The arguments must outlive this object.
    WideTree(const rt_host* host, const Collapse<Width>& collapse, const WideSubtrees<Width>& subtrees,
             const WideLayout<Width>& layout, const std::vector<Root>& groups, const Costs& costs)
        : host_(host), collapse_(collapse), subtrees_(subtrees), layout_(layout), groups_(groups), costs_(costs) {}

    // Writes all nodes, group by group, and reports the roots.
    void write(const WideOutput<Width>& out);

    uint32_t node_count() const { return node_count_; }
    uint32_t depth() const { return depth_; }  // number of nodes on the path from a root to the deepest leaf
    // The largest number of children that are deferred at any time during a traversal, in any order of visits.
    uint32_t stack() const { return stack_; }
    WideStatistics statistics(const rt_group* groups) const;

 private:
    // A subtree that one thread counts and writes.
    struct Job {
        uint32_t binary, group;
        uint32_t nodes = 0, place = 0;
        WideSums sums;
    };
    // A wide node above the jobs.
    struct Above {
        uint32_t group;
        uint32_t count = 0;
        Slot slots[Width];
        uint32_t below[Width] = {};  // for slots that are nodes: index in tops_, or in jobs_ with kJob
        uint32_t place = 0;
    };
    static constexpr uint32_t kJob = 0x80000000u;

    uint32_t expand_root(uint32_t group);
    uint32_t expand(uint32_t binary, uint32_t group);
    WideExtent measure_top(uint32_t code, const std::vector<WideExtent>& jobs) const;
    uint32_t place(uint32_t code, uint32_t next);
    uint32_t place_of(uint32_t code) const { return code & kJob ? jobs_[code & ~kJob].place : tops_[code].place; }

    const rt_host* const host_;
    const Collapse<Width>& collapse_;
    const WideSubtrees<Width>& subtrees_;
    const WideLayout<Width>& layout_;
    const std::vector<Root>& groups_;
    const Costs costs_;
    std::vector<Job> jobs_;
    std::vector<Above> tops_;
    std::vector<std::array<float, 8>> root_boxes_;  // of the groups that are a single leaf
    WideNode<Width>* nodes_ = nullptr;
    uint32_t node_count_ = 0;
    uint32_t depth_ = 1, stack_ = 0;
};

extern template class CollapsedSubtrees<4>;
extern template class CollapsedSubtrees<8>;
extern template class WideTree<4>;
extern template class WideTree<8>;

}  // namespace clarity::bvh
