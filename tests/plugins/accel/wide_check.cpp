#include "wide_check.hpp"

#include <algorithm>
#include <bitset>
#include <cfloat>
#include <cmath>

#include "findings.hpp"
#include "leaf_tally.hpp"

namespace accel_test {
namespace {

class Bvh8Checker : Findings {
 public:
    Bvh8Checker(const Input& input, const Built& built, uint32_t max_leaf, double traversal_cost, double intersection_cost)
        : Findings(built),
          input_(input),
          max_leaf_(max_leaf),
          traversal_cost_(traversal_cost),
          intersection_cost_(intersection_cost),
          leaves_(input, built) {}

    std::string run() {
        if (built_.leaves.size() != input_.prims.size())
            say() << built_.leaves.size() << " leaves for " << input_.prims.size() << " primitives";
        for (uint32_t g = 0; g < input_.groups.size() && none(); ++g) {
            group_ = g;
            area_cost_ = 0;
            if (built_.roots[g] != next_) say() << "the root of group " << g << " is not behind the last group";
            const Visited whole = visit(built_.roots[g], 1);
            const double area = whole.bounds.area();
            if (area > 0) {
                cost_ += input_.groups[g].count * (traversal_cost_ + area_cost_ / area);
                weight_ += input_.groups[g].count;
            }
        }
        if (!none()) return all();
        if (next_ != built_.slot_counts[0]) say() << built_.slot_counts[0] - next_ << " nodes belong to no tree";
        if (const std::string missing = leaves_.missing(); !missing.empty()) say() << missing;
        expect("nodes", static_cast<double>(next_));
        expect("leaves", leaf_count_);
        expect("depth", depth_);
        expect("node_bytes", 224.0 * static_cast<double>(next_));
        expect("children", child_count_ / static_cast<double>(next_));
        expect("sah_cost", weight_ > 0 ? cost_ / weight_ : 0);
        const rt_u32 stack = built_.defines.at("BVH8_STACK");
        const rt_u32 least = (stack_ + 1 + 15) / 16 * 16;
        if (stack != (least % 64 == 0 ? least + 16 : least)) say() << "stack of " << stack << " for " << stack_;
        if (depth_ > 64) say() << "depth " << depth_;
        return all();
    }

 private:
    struct Visited {
        Bounds bounds;
        uint32_t stack = 0;  // largest number of deferred children, including this node's
    };

    Visited visit(rt_u32 index, uint32_t depth) {
        Visited result;
        if (!none()) return result;
        if (index != next_ || index >= built_.slot_counts[0]) {
            say() << "node " << index << " stands where " << next_ << " should";
            return result;
        }
        ++next_;
        depth_ = std::max(depth_, depth);
        const bvh8_node& node = built_.slot<bvh8_node>()[index];
        if (reinterpret_cast<uintptr_t>(&node) % 32 != 0) say() << "node " << index << " is not aligned";
        uint32_t children = 0, below = 0;
        std::vector<std::pair<rt_u32, int>> nodes;  // in the order of their indices
        for (int slot = 0; slot < BVH8_WIDTH; ++slot) {
            const rt_u32 child = node.child[slot];
            float box[6];
            for (int k = 0; k < 6; ++k) box[k] = node.plane[k][slot];
            if (child == BVH8_EMPTY) {
                for (const float plane : box)
                    if (plane != FLT_MAX) say() << "slot " << slot << " of node " << index << " is empty and in reach";
                continue;
            }
            ++children;
            if (child & BVH8_LEAF)
                expect_box(index, box, visit_leaf(index, child));
            else
                nodes.push_back({child, slot});
            result.bounds.add(box, box + 3);
            Bounds own;
            own.add(box, box + 3);
            area_cost_ += own.area() * (child & BVH8_LEAF ? intersection_cost_ * BVH8_LEAF_COUNT(child) : traversal_cost_);
        }
        std::sort(nodes.begin(), nodes.end());
        for (const auto& [child, slot] : nodes) {
            const Visited there = visit(child, depth + 1);
            float box[6];
            for (int k = 0; k < 6; ++k) box[k] = node.plane[k][slot];
            expect_box(index, box, there.bounds);
            below = std::max(below, there.stack);
        }
        child_count_ += children;
        if (children < 2 && (depth > 1 || input_.groups[group_].count > max_leaf_))
            say() << "node " << index << " has " << children << " children";
        result.stack = std::max(children, below > 0 ? below + children - 1 : 0);
        stack_ = std::max(stack_, result.stack);
        return result;
    }

    void expect_box(rt_u32 index, const float box[6], const Bounds& below) {
        for (int a = 0; a < 3; ++a)
            if (none() && (box[a] != below.lo[a] || box[3 + a] != below.hi[a]))
                say() << "a box of node " << index << " is not that of what is below";
    }

    Bounds visit_leaf(rt_u32 index, rt_u32 child) {
        ++leaf_count_;
        const uint32_t first = BVH8_LEAF_FIRST(child), count = BVH8_LEAF_COUNT(child);
        if (count == 0 || count > max_leaf_) say() << "leaf of " << count << " below node " << index;
        std::string why;
        const Bounds below = leaves_.visit(first, count, group_, why);
        if (!why.empty()) say() << why;
        return below;
    }

    const Input& input_;
    const uint32_t max_leaf_;
    const double traversal_cost_, intersection_cost_;
    uint32_t group_ = 0, depth_ = 0, stack_ = 0;
    rt_u32 next_ = 0;  // index that the next node should have
    double leaf_count_ = 0, child_count_ = 0, area_cost_ = 0, cost_ = 0, weight_ = 0;
    LeafTally leaves_;
};

}  // namespace

std::string check_bvh8(const Input& input, const Built& built, uint32_t max_leaf, double traversal_cost,
                       double intersection_cost) {
    if (built.status != RT_OK) return "the build failed: " + built.why;
    return Bvh8Checker(input, built, max_leaf, traversal_cost, intersection_cost).run();
}

namespace {

class CwbvhChecker : Findings {
 public:
    CwbvhChecker(const Input& input, const Built& built, uint32_t max_leaf)
        : Findings(built), input_(input), max_leaf_(max_leaf), node_seen_(built.slot_counts[0]), leaves_(input, built) {}

    std::string run() {
        if (built_.leaves.size() != input_.prims.size())
            say() << built_.leaves.size() << " leaves for " << input_.prims.size() << " primitives";
        for (group_ = 0; group_ < input_.groups.size() && none(); ++group_) visit(built_.roots[group_], 1);
        if (!none()) return all();
        for (size_t i = 0; i < node_seen_.size(); ++i)
            if (!node_seen_[i]) say() << "node " << i << " belongs to no tree";
        if (const std::string missing = leaves_.missing(); !missing.empty()) say() << missing;
        expect("nodes", static_cast<double>(node_seen_.size()));
        expect("leaves", leaf_count_);
        expect("depth", depth_);
        expect("node_bytes", 80.0 * static_cast<double>(node_seen_.size()));
        expect_stack("CWBVH_STACK", stack_);
        expect_stack("CWBVH_DEPTH", depth_);
        return all();
    }

 private:
    struct Visited {
        Bounds bounds;
        uint32_t stack = 0;  // largest number of deferred children, including this node's
    };

    void expect_stack(const char* name, uint32_t entries) {
        const rt_u32 stack = built_.defines.at(name);
        if (stack < entries + 1 || stack % 16 != 0 || stack > entries + 32)
            say() << name << " of " << stack << " for " << entries;
    }

    Visited visit(rt_u32 index, uint32_t depth) {
        Visited result;
        if (!none()) return result;
        if (index >= node_seen_.size() || node_seen_[index]) {
            say() << "node " << index << (index < node_seen_.size() ? " is in two places" : " is out of range");
            return result;
        }
        node_seen_[index] = true;
        depth_ = std::max(depth_, depth);
        const cwbvh_node& node = built_.slot<cwbvh_node>()[index];
        if (reinterpret_cast<uintptr_t>(&node) % 16 != 0) say() << "node " << index << " is not aligned";
        rt_u32 next_child = node.first_child, next_leaf = node.first_leaf;
        uint32_t children = 0, below = 0;
        for (uint32_t slot = 0; slot < 8; ++slot) {
            const bool inner = node.cells >> (24 + slot) & 1u;
            const rt_u32 mask = node.primitives >> 4 * slot & 15u;
            if (!inner && mask == 0) {
                for (int a = 0; a < 3; ++a)
                    if (byte(node, a, slot, 0) != 255 || byte(node, a, slot, 1) != 0)
                        say() << "slot " << slot << " of node " << index << " is empty and in reach";
                continue;
            }
            ++children;
            if (inner && mask != 0) say() << "slot " << slot << " of node " << index << " is a node and a leaf";
            Bounds there;
            if (inner) {
                const Visited visited = visit(next_child++, depth + 1);
                there = visited.bounds;
                below = std::max(below, visited.stack);
            } else {
                const auto count = static_cast<uint32_t>(std::bitset<4>(mask).count());
                if ((mask & (mask + 1)) != 0 || count > max_leaf_) say() << "leaf of bits " << mask << " in node " << index;
                there = visit_leaf(next_leaf, count);
                next_leaf += count;
                ++leaf_count_;
            }
            if (!none()) return result;
            expect_around(index, node, slot, there);
            for (int a = 0; a < 3; ++a) {
                result.bounds.lo[a] = std::min(result.bounds.lo[a], there.lo[a]);
                result.bounds.hi[a] = std::max(result.bounds.hi[a], there.hi[a]);
            }
        }
        result.stack = std::max(children, below > 0 ? below + children - 1 : 0);
        stack_ = std::max(stack_, result.stack);
        return result;
    }

    static int byte(const cwbvh_node& node, int axis, uint32_t slot, int side) {
        return static_cast<int>(node.planes[axis][slot / 4 + 2 * side] >> 8 * (slot % 4) & 255u);
    }

    void expect_around(rt_u32 index, const cwbvh_node& node, uint32_t slot, const Bounds& there) {
        for (int a = 0; a < 3; ++a) {
            if (std::isnan(node.origin[a])) continue;  // unbounded
            const long double cell = std::ldexp(1.0L, static_cast<int>(node.cells >> 8 * a & 255u) - 127);
            const long double zero = static_cast<long double>(node.origin[a]) + 32768 * cell;
            const long double least = cell / 129, most = cell * (1 + 1.0L / 127);
            const long double lo = there.lo[a] - (zero + byte(node, a, slot, 0) * cell),
                              hi = zero + byte(node, a, slot, 1) * cell - there.hi[a];
            if (lo < least || hi < least)
                say() << "slot " << slot << " of node " << index << " does not hold what is below in axis " << a;
            if (lo > most || hi > most) say() << "slot " << slot << " of node " << index << " is too wide in axis " << a;
        }
    }

    Bounds visit_leaf(rt_u32 first, uint32_t count) {
        std::string why;
        const Bounds below = leaves_.visit(first, count, group_, why);
        if (!why.empty()) say() << why;
        return below;
    }

    const Input& input_;
    const uint32_t max_leaf_;
    uint32_t group_ = 0, depth_ = 0, stack_ = 0;
    double leaf_count_ = 0;
    std::vector<bool> node_seen_;
    LeafTally leaves_;
};

}  // namespace

std::string check_cwbvh(const Input& input, const Built& built, uint32_t max_leaf) {
    if (built.status != RT_OK) return "the build failed: " + built.why;
    return CwbvhChecker(input, built, max_leaf).run();
}

}  // namespace accel_test
