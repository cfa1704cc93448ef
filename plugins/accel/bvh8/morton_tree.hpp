// morton_tree.hpp -- the wide tree of primitives that are sorted along a curve: the fast builder's. The thread that sorts a run
// makes its binary tree, decides what becomes of that and writes the wide nodes, all within its caches; the binary tree goes.
#pragma once
#include <memory>

#include "morton.hpp"
#include "wide_tree.hpp"

namespace bvh8 {

class MortonTree : public Subtrees {
 public:
    // Of memory that is given back at the end, about.
    static uint64_t bytes(uint64_t primitive_count);

    // Writes the leaf order. Progress goes from 0 to `share`.
    MortonTree(const rt_host* host, const rt_build_input& input, const rt_build_output* out, const Costs& costs,
               uint64_t primitive_count, float share);

    // What is above the subtrees of runs.
    const Collapse& collapse() const { return *collapse_; }
    const std::vector<bvh2::Root>& roots() const { return roots_; }
    Extent measure(rt_u32 binary) const override { return of_binary(binary).extent; }
    bool measured() const override { return true; }
    void write(rt_u32 binary, bvh8_node* nodes, rt_u32 at, Sums& sums) const override;

 private:
    // A subtree that is finished: a wide node and all below it.
    struct Part {
        rt_u32 run, first;  // of the run's nodes
        Extent extent;
        Sums sums;
        float cost;  // as one root
    };
    // What became of a run. Its root, as a wide node, would end the choice of what is above it: the binary nodes that the root
    // merges are kept, parents before children, to be decided once more together with the tops.
    struct Finished {
        bvh2::Bounds box;
        rt_u32 root = 0;               // a leaf, or the first of `upper`, or a part (whole groups)
        std::vector<bvh2_node> upper;  // children: leaves, others of `upper`, parts
        std::vector<Part> parts;
        std::vector<bvh8_node> nodes;
    };
    class RunBuilder;
    // Codes of children in Finished that are parts.
    static constexpr rt_u32 kPart = 0x40000000u;

    void join(const bvh2::MortonOrder& order, const Costs& costs);
    const Part& of_binary(rt_u32 binary) const { return parts_[binary - first_part_]; }

    std::vector<Finished> runs_;
    std::vector<bvh2::Root> roots_;
    // Nodes above the parts: tops, what is left of the runs, and for each part one that says nothing but its costs.
    std::vector<bvh2_node> nodes_;
    std::vector<RootCosts> root_costs_;
    std::vector<Part> parts_;
    rt_u32 first_part_ = 0;
    std::unique_ptr<const Collapse> collapse_;
};

}  // namespace bvh8
