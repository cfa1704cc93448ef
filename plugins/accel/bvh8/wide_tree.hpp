// wide_tree.hpp -- writes the nodes of the wide tree on all cores, as Collapse has decided them.
#pragma once
#include <array>
#include <vector>

#include "collapse.hpp"

namespace bvh8 {

// Statistics of a finished tree, collected while its nodes are written.
struct Statistics {
    uint64_t leaves = 0, children = 0;
    // Expected cost of a ray that hits the root's box. Each node and primitive counts with its probability of a visit (its
    // surface over the root's) times its cost. It is the mean over all groups, weighted by their numbers of primitives.
    double sah_cost = 0;
};

// Sums over the children of some nodes.
struct Sums {
    uint64_t leaves = 0, children = 0;
    double node_area = 0, primitive_area = 0;
    void add(const Slot* slots, uint32_t count);
    void add(const Sums& other);
};

// The size of a subtree; see WideTree for the members.
struct Extent {
    rt_u32 nodes = 1;
    uint32_t depth = 1, stack = 0;
    void add(const Extent& child, uint32_t siblings);
};

// The subtrees of the wide tree that single threads count and write. Each is identified by the binary node that it was made
// from. All functions may be called from any thread.
class Subtrees {
 public:
    virtual ~Subtrees() = default;
    virtual Extent measure(rt_u32 binary) const = 0;
    virtual bool measured() const { return false; }  // true: measure() costs nothing
    // Writes the subtree depth-first from nodes[at] on, and adds its sums to `sums`.
    virtual void write(rt_u32 binary, bvh8_node* nodes, rt_u32 at, Sums& sums) const = 0;
};

// Subtrees that are written from a binary tree which still exists.
class CollapsedSubtrees : public Subtrees {
 public:
    explicit CollapsedSubtrees(const Collapse& collapse) : collapse_(collapse) {}
    Extent measure(rt_u32 binary) const override;
    void write(rt_u32 binary, bvh8_node* nodes, rt_u32 at, Sums& sums) const override {
        write_subtree(binary, nodes, at, sums);
    }

 private:
    rt_u32 write_subtree(rt_u32 binary, bvh8_node* nodes, rt_u32 at, Sums& sums) const;
    const Collapse& collapse_;
};

class WideTree {
 public:
    // Nodes above the tasks come from `collapse`, nodes below from `subtrees`. The arguments must outlive this object.
    WideTree(const rt_host* host, const Collapse& collapse, const Subtrees& subtrees, const std::vector<bvh2::Root>& groups,
             const Costs& costs)
        : host_(host), collapse_(collapse), subtrees_(subtrees), groups_(groups), costs_(costs) {}

    // Allocates slot 0, writes all nodes and reports the roots of the groups. The host owns the nodes.
    void write(const rt_build_output* out);

    rt_u32 node_count() const { return node_count_; }
    uint32_t depth() const { return depth_; }  // number of nodes on the path from a root to the deepest leaf
    // The largest number of children that are deferred at any time during a traversal, in any order of visits.
    uint32_t stack() const { return stack_; }
    Statistics statistics(const rt_group* groups) const;

 private:
    // A subtree that one thread counts and writes.
    struct Job {
        rt_u32 binary, group;
        rt_u32 nodes = 0, place = 0;
        Sums sums;
    };
    // A wide node above the jobs.
    struct Top {
        rt_u32 group;
        uint32_t count = 0;
        Slot slots[BVH8_WIDTH];
        rt_u32 below[BVH8_WIDTH] = {};  // for slots that are nodes: index in tops_, or in jobs_ with kJob
        rt_u32 place = 0;
    };
    static constexpr rt_u32 kJob = 0x80000000u;

    rt_u32 expand_root(rt_u32 group);
    rt_u32 expand(rt_u32 binary, rt_u32 group);
    Extent measure_top(rt_u32 code, const std::vector<Extent>& jobs) const;
    rt_u32 place(rt_u32 code, rt_u32 next);
    rt_u32 place_of(rt_u32 code) const { return code & kJob ? jobs_[code & ~kJob].place : tops_[code].place; }

    const rt_host* const host_;
    const Collapse& collapse_;
    const Subtrees& subtrees_;
    const std::vector<bvh2::Root>& groups_;
    const Costs costs_;
    std::vector<Job> jobs_;
    std::vector<Top> tops_;
    std::vector<std::array<float, 8>> root_boxes_;  // of the groups that are a single leaf
    bvh8_node* nodes_ = nullptr;
    rt_u32 node_count_ = 0;
    uint32_t depth_ = 1, stack_ = 0;
};

}  // namespace bvh8
