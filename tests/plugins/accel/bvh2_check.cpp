#include "bvh2_check.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "findings.hpp"
#include "leaf_tally.hpp"

namespace accel_test {
namespace {

bool is_empty_child(rt_u32 child) {
    return child == BVH2_MAKE_LEAF(0u, 0u);
}

class Bvh2Checker : Findings {
 public:
    Bvh2Checker(const Input& input, const Built& built, uint32_t max_leaf, bool larger_first)
        : Findings(built),
          input_(input),
          max_leaf_(max_leaf),
          larger_first_(larger_first),
          node_seen_(built.slot_counts[0]),
          leaves_(input, built) {}

    std::string run() {
        if (built_.leaves.size() != input_.prims.size())
            say() << built_.leaves.size() << " leaves for " << input_.prims.size() << " primitives";
        for (uint32_t g = 0; g < input_.groups.size() && none(); ++g) {
            group_ = g;
            if (built_.roots[g] >= node_seen_.size()) return "root out of range";
            visit(built_.roots[g], 1);
        }
        if (!none()) return all();
        for (size_t i = 0; i < node_seen_.size(); ++i)
            if (!node_seen_[i]) say() << "node " << i << " belongs to no tree";
        if (const std::string missing = leaves_.missing(); !missing.empty()) say() << missing;
        const auto expect = [&](const char* label, double value) {
            const auto found = built_.stats.find(label);
            if (found == built_.stats.end() || found->second != value) say() << "stat " << label << " is not " << value;
        };
        expect("nodes", static_cast<double>(node_seen_.size()));
        expect("leaves", leaf_count_);
        expect("depth", depth_);
        const rt_u32 stack = built_.defines.at("BVH2_STACK");
        if (stack < depth_ + 1 || stack % 8 != 0 || stack > depth_ + 8)
            say() << "stack of " << stack << " for depth " << depth_;
        if (depth_ > 64) say() << "depth " << depth_;
        return all();
    }

 private:
    Bounds visit(rt_u32 index, uint32_t depth) {
        Bounds both;
        if (!none()) return both;
        if (node_seen_[index]) {
            say() << "node " << index << " has two parents";
            return both;
        }
        node_seen_[index] = true;
        depth_ = std::max(depth_, depth);
        const bvh2_node& node = built_.slot<bvh2_node>()[index];
        if (reinterpret_cast<uintptr_t>(&node) % 64 != 0) say() << "node " << index << " is not aligned";
        Bounds b0, b1;
        b0.add(node.box0, node.box0 + 3);
        b1.add(node.box1, node.box1 + 3);
        // The builder compares areas in float, and boxes around a line have almost no area.
        if (larger_first_ && !is_empty_child(node.child1) && b0.area() < 0.99 * b1.area() && b0.longest() < 0.99 * b1.longest())
            say() << "child 0 of node " << index << " is the smaller one";
        visit_child(index, node.box0, node.child0, depth, both);
        visit_child(index, node.box1, node.child1, depth, both);
        return both;
    }

    void visit_child(rt_u32 index, const float* box, rt_u32 child, uint32_t depth, Bounds& both) {
        if (!none()) return;
        if (is_empty_child(child)) {
            if (depth > 1 || input_.groups[group_].count > max_leaf_) say() << "node " << index << " lacks a child";
            for (int i = 0; i < 6; ++i)
                if (box[i] != FLT_MAX) say() << "the child that node " << index << " lacks is in reach";
            return;
        }
        Bounds below;
        if (child & BVH2_LEAF) {
            ++leaf_count_;
            const uint32_t first = BVH2_LEAF_FIRST(child), count = BVH2_LEAF_COUNT(child);
            if (count == 0 || count > max_leaf_) say() << "leaf of " << count << " below node " << index;
            std::string why;
            below = leaves_.visit(first, count, group_, why);
            if (!why.empty()) {
                say() << why;
                return;
            }
        } else if (child >= node_seen_.size()) {
            say() << "node " << index << " has child " << child;
            return;
        } else {
            if (box == built_.slot<bvh2_node>()[index].box0 && child != index + 1)
                say() << "child 0 of node " << index << " is not beside it";
            below = visit(child, depth + 1);
        }
        for (int a = 0; a < 3; ++a) {
            const bool equal = box[a] == below.lo[a] && box[3 + a] == below.hi[a];
            if (!equal) say() << "a box of node " << index << " is not that of what is below";
        }
        both.add(box, box + 3);
    }

    const Input& input_;
    const uint32_t max_leaf_;
    const bool larger_first_;
    uint32_t group_ = 0, depth_ = 0;
    double leaf_count_ = 0;
    std::vector<bool> node_seen_;
    LeafTally leaves_;
};

}  // namespace

std::string check_bvh2(const Input& input, const Built& built, uint32_t max_leaf, bool larger_first) {
    if (built.status != RT_OK) return "the build failed: " + built.why;
    return Bvh2Checker(input, built, max_leaf, larger_first).run();
}

double sah_cost(const Input& input, const Built& built, double traversal_cost, double intersection_cost) {
    double sum = 0, weight = 0;
    for (uint32_t g = 0; g < input.groups.size(); ++g) {
        double cost = 0;
        Bounds whole;
        std::vector<rt_u32> stack{built.roots[g]};
        while (!stack.empty()) {
            const bvh2_node& node = built.slot<bvh2_node>()[stack.back()];
            const bool is_root = stack.back() == built.roots[g];
            stack.pop_back();
            const auto add = [&](const float* box, rt_u32 child) {
                if (is_empty_child(child)) return;
                Bounds b;
                b.add(box, box + 3);
                if (is_root) whole.add(box, box + 3);
                cost += b.area() * (child & BVH2_LEAF ? intersection_cost * BVH2_LEAF_COUNT(child) : traversal_cost);
                if (!(child & BVH2_LEAF)) stack.push_back(child);
            };
            add(node.box0, node.child0);
            add(node.box1, node.child1);
        }
        if (!(whole.area() > 0)) continue;
        sum += input.groups[g].count * (traversal_cost + cost / whole.area());
        weight += input.groups[g].count;
    }
    return weight > 0 ? sum / weight : 0;
}

}  // namespace accel_test
