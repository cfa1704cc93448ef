#include "cwbvh_check.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>

#include "findings.hpp"
#include "leaf_tally.hpp"

namespace accel_test {
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
