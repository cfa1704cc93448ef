// morton_tree.hpp -- the wide tree of the fast builder, from primitives sorted along a curve. The thread that sorts a run also
// builds its binary tree, decides the collapse and writes the wide nodes, all in its caches. The binary tree of the run is not
// kept.
#pragma once
#include <memory>

#include "morton.hpp"
#include "wide_tree.hpp"

namespace bvh8 {

class MortonTree : public Subtrees {
 public:
    // Returns the approximate temporary memory of a build, in bytes. It is freed when this object is destroyed.
    static uint64_t bytes(uint64_t primitive_count);

    // Builds the subtrees of all runs and writes the leaf order. Reports progress from 0 to `share`.
    MortonTree(const rt_host* host, const rt_build_input& input, const rt_build_output* out, const Costs& costs,
               uint64_t primitive_count, float share);

    // The collapse of the nodes above the runs' subtrees.
    const Collapse& collapse() const { return *collapse_; }
    const std::vector<bvh2::Root>& roots() const { return roots_; }
    Extent measure(rt_u32 binary) const override { return of_binary(binary).extent; }
    bool measured() const override { return true; }
    void write(rt_u32 binary, bvh8_node* nodes, rt_u32 at, Sums& sums) const override;

 private:
    // A finished subtree: a wide node and everything below it.
    struct Part {
        rt_u32 run, first;  // first: index in the run's nodes
        Extent extent;
        Sums sums;
        float cost;  // as one root
    };
    // A finished run. If its root became a wide node, the choice of the nodes above would be limited. So the binary nodes that
    // the root would merge are kept (parents before children), and they are decided again together with the tops.
    struct Finished {
        bvh2::Bounds box;
        rt_u32 root = 0;               // a leaf, or index 0 of `upper`, or a part (if the run is a whole group)
        std::vector<bvh2_node> upper;  // children: leaves, other nodes of `upper`, or parts
        std::vector<Part> parts;
        std::vector<bvh8_node> nodes;
    };
    class RunBuilder;
    // With this bit, a child code in Finished is the index of a part.
    static constexpr rt_u32 kPart = 0x40000000u;

    void join(const bvh2::MortonOrder& order, const Costs& costs);
    const Part& of_binary(rt_u32 binary) const { return parts_[binary - first_part_]; }

    std::vector<Finished> runs_;
    std::vector<bvh2::Root> roots_;
    // The nodes above the parts: first the tops, then the kept nodes of the runs, then one node per part that carries its costs
    // only.
    std::vector<bvh2_node> nodes_;
    std::vector<RootCosts> root_costs_;
    std::vector<Part> parts_;
    rt_u32 first_part_ = 0;
    std::unique_ptr<const Collapse> collapse_;
};

}  // namespace bvh8
