// wide_tree.hpp -- writes the nodes that were decided on, on all cores.
#pragma once
#include <array>
#include <vector>

#include "collapse.hpp"

namespace bvh8 {

// What a finished tree is worth, measured on the nodes as they are written.
struct Statistics {
    uint64_t leaves = 0, children = 0;
    // Expected cost of a ray that meets the root's box: nodes and primitives, weighted by how likely each is met (its surface
    // over the root's) and by the costs; the mean over all groups, weighted by their primitives.
    double sah_cost = 0;
};

class WideTree {
 public:
    WideTree(const rt_host* host, const Collapse& collapse, const bvh2::BinaryTree& tree, const Costs& costs)
        : host_(host), collapse_(collapse), tree_(tree), costs_(costs) {}

    // Allocates slot 0 and reports the groups' roots.
    void write(const rt_build_output* out);

    rt_u32 node_count() const { return node_count_; }
    uint32_t depth() const { return depth_; }  // nodes from a root to the deepest leaf
    // Children put off at most while one of them is visited, whatever the order of visits.
    uint32_t stack() const { return stack_; }
    Statistics statistics(const rt_group* groups) const;

 private:
    // Over some nodes: their children.
    struct Sums {
        uint64_t leaves = 0, children = 0;
        double node_area = 0, primitive_area = 0;
        void add(const Slot* slots, uint32_t count);
    };
    // A subtree that one thread counts and writes.
    struct Job {
        rt_u32 binary, group;
        rt_u32 nodes = 0, place = 0;
        Sums sums;
    };
    // A node above the jobs.
    struct Top {
        rt_u32 group;
        uint32_t count = 0;
        Slot slots[BVH8_WIDTH];
        rt_u32 below[BVH8_WIDTH] = {};  // of slots that are nodes: index in tops_, or with kJob in jobs_
        rt_u32 place = 0;
    };
    static constexpr rt_u32 kJob = 0x80000000u;
    struct Extent {
        rt_u32 nodes = 1;
        uint32_t depth = 1, stack = 0;
        void add(const Extent& child, uint32_t siblings);
    };

    rt_u32 expand_root(rt_u32 group);
    rt_u32 expand(rt_u32 binary, rt_u32 group);
    Extent measure(rt_u32 binary) const;
    Extent measure_top(rt_u32 code, const std::vector<Extent>& jobs) const;
    rt_u32 place(rt_u32 code, rt_u32 next);
    rt_u32 place_of(rt_u32 code) const { return code & kJob ? jobs_[code & ~kJob].place : tops_[code].place; }
    rt_u32 write_subtree(rt_u32 binary, rt_u32 at, Sums& sums) const;

    const rt_host* const host_;
    const Collapse& collapse_;
    const bvh2::BinaryTree& tree_;
    const Costs costs_;
    std::vector<Job> jobs_;
    std::vector<Top> tops_;
    std::vector<std::array<float, 8>> root_boxes_;  // of groups that are one leaf
    bvh8_node* nodes_ = nullptr;
    rt_u32 node_count_ = 0;
    uint32_t depth_ = 1, stack_ = 0;
};

}  // namespace bvh8
