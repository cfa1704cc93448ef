// wide_tree.hpp -- writes the nodes that were decided on, on all cores.
#pragma once
#include <vector>

#include "collapse.hpp"

namespace bvh8 {

class WideTree {
 public:
    explicit WideTree(const rt_host* host, const Collapse& collapse) : host_(host), collapse_(collapse) {}

    // Allocates slot 0 and reports the groups' roots.
    void write(const rt_build_output* out);

    const bvh8_node* nodes() const { return nodes_; }
    rt_u32 node_count() const { return node_count_; }
    const std::vector<rt_u32>& roots() const { return roots_; }
    uint32_t depth() const { return depth_; }  // nodes from a root to the deepest leaf
    // Children put off at most while one of them is visited, whatever the order of visits.
    uint32_t stack() const { return stack_; }

 private:
    // A subtree that one thread counts and writes.
    struct Job {
        rt_u32 binary;
        rt_u32 nodes = 0, place = 0;
    };
    // A node above the jobs.
    struct Top {
        Slot slots[BVH8_WIDTH];
        uint32_t count = 0;
        rt_u32 below[BVH8_WIDTH] = {};  // of slots that are nodes: index in tops_, or with kJob in jobs_
        rt_u32 place = 0;
    };
    static constexpr rt_u32 kJob = 0x80000000u;
    struct Extent {
        rt_u32 nodes = 1;
        uint32_t depth = 1, stack = 0;
        void add(const Extent& child, uint32_t siblings);
    };

    rt_u32 expand(rt_u32 binary);
    Extent measure(rt_u32 binary) const;
    Extent measure_top(rt_u32 code, const std::vector<Extent>& jobs) const;
    rt_u32 place(rt_u32 code, rt_u32 next);
    rt_u32 place_of(rt_u32 code) const { return code & kJob ? jobs_[code & ~kJob].place : tops_[code].place; }
    rt_u32 write_subtree(rt_u32 binary, rt_u32 at) const;

    const rt_host* const host_;
    const Collapse& collapse_;
    std::vector<Job> jobs_;
    std::vector<Top> tops_;
    bvh8_node* nodes_ = nullptr;
    rt_u32 node_count_ = 0;
    std::vector<rt_u32> roots_;
    uint32_t depth_ = 1, stack_ = 0;
};

}  // namespace bvh8
