// wide_morton.hpp -- the wide tree of the fast builder, from primitives sorted along a curve. The thread that sorts a run also
// builds its binary tree, decides the collapse and writes the wide nodes, all in its caches. The binary tree of the run is not
// kept.
#pragma once
#include <memory>

#include "clarity_bvh/build/builder.hpp"
#include "clarity_bvh/build/morton.hpp"
#include "clarity_bvh/wide/wide_tree.hpp"

namespace clarity::bvh {

template <uint32_t Width>
class WideMorton : public WideSubtrees<Width> {
 public:
    // Returns the approximate temporary memory of a build, in bytes. It is freed when this object is destroyed.
    static uint64_t bytes(uint64_t primitive_count);

    // Builds the subtrees of all runs and writes the leaf order. Reports progress from 0 to `share`. `layout` must outlive this
    // object; costs.max_leaf is at most kLeafMax. Throws as build_topology() does.
    WideMorton(const rt_host* host, const rt_build_input& input, const RefMemory& refs, const WideLayout<Width>& layout,
               const Costs& costs, uint64_t primitive_count, float share);

    // The collapse of the nodes above the runs' subtrees.
    const Collapse<Width>& collapse() const { return *collapse_; }
    const std::vector<Root>& roots() const { return roots_; }
    WideExtent measure(uint32_t binary) const override { return of_binary(binary).extent; }
    bool measured() const override { return true; }
    void write(uint32_t binary, WideNode<Width>* nodes, uint32_t at, WideSums& sums) const override;

 private:
    // A finished subtree: a wide node and everything below it.
    struct Branch {
        uint32_t run, first;  // first: index in the run's nodes
        WideExtent extent;
        WideSums sums;
        float cost;  // as one root
    };
    // A finished run. If its root became a wide node, the choice of the nodes above would be limited. So the binary nodes that
    // the root would merge are kept (parents before children), and they are decided again together with the tops.
    struct Finished {
        Bounds box;
        uint32_t root = 0;        // a leaf, or index 0 of `upper`, or a part (if the run is a whole group)
        std::vector<Node> upper;  // children: leaves, other nodes of `upper`, or parts
        std::vector<Branch> parts;
        std::vector<WideNode<Width>> nodes;
    };
    class RunBuilder;
    // With this bit, a child code in Finished is the index of a part.
    static constexpr uint32_t kPart = 0x40000000u;

    void join(const MortonOrder& order, const Costs& costs);
    const Branch& of_binary(uint32_t binary) const { return parts_[binary - first_part_]; }

    std::vector<Finished> runs_;
    std::vector<Root> roots_;
    // The nodes above the parts: first the tops, then the kept nodes of the runs, then one node per part that carries its costs
    // only.
    std::vector<Node> nodes_;
    std::vector<RootCosts> root_costs_;
    std::vector<Branch> parts_;
    const WideLayout<Width>& layout_;
    uint32_t first_part_ = 0;
    std::unique_ptr<const Collapse<Width>> collapse_;
};

extern template class WideMorton<4>;
extern template class WideMorton<8>;

}  // namespace clarity::bvh
