#include "collapse.hpp"

#include <algorithm>
#include <cmath>

namespace bvh8 {
namespace {

static_assert(bvh2::kRoots >= BVH8_WIDTH, "roots become children");

bool is_leaf(rt_u32 code) {
    return (code & BVH2_LEAF) != 0;
}

// Added to each side length, so that lines and points cost more than nothing. Too small to matter for anything that has an
// area.
constexpr float kLeast = 1e-12f;

using bvh2::Vec4;

// Halves the coordinates before it subtracts them, so that no length overflows.
float half_area(Vec4 lo, Vec4 hi, float scale) {
    const Vec4 half = bvh2::splat(0.5f);
    alignas(16) float e[4];
    bvh2::store(e, bvh2::splat(kLeast) + bvh2::splat(scale) * (half * bvh2::xyz(hi) - half * bvh2::xyz(lo)));
    return e[0] * e[1] + e[2] * (e[0] + e[1]);
}
// Half area of the box around both children.
float half_area(const bvh2_node& node, float scale) {
    return half_area(bvh2::min(bvh2::load_any(node.box1), bvh2::load_any(node.box0)),
                     bvh2::max(bvh2::load_any(node.box1 + 3), bvh2::load_any(node.box0 + 3)), scale);
}
// Reads seven numbers.
float half_area(const float box[6], float scale) {
    return half_area(bvh2::load_any(box), bvh2::load_any(box + 3), scale);
}

}  // namespace

void Collapse::decide_task(const bvh2::Task& task) const {
    for (rt_u32 i = task.first_node + task.tree.nodes; i-- > task.first_node;) decide(i, task.scale, 0);
}

void Collapse::decide_tops(const bvh2::BinaryTree& tree) const {
    for (size_t i = tree.tops.size(); i-- > 0;) decide(tree.tops[i].node, tree.tops[i].scale, Decision::kIsTop);
}

void Collapse::decide(rt_u32 binary, float scale, rt_u32 more_bits) const {
    bvh2_node& node = nodes_[binary];
    float left[bvh2::kRoots] = {}, right[2 * bvh2::kRoots] = {};  // entries from BVH8_WIDTH on are not read
    uint32_t count = 0;
    rt_u32 first = RT_NONE;
    bool may_be_leaf = true;
    std::fill_n(right, bvh2::kRoots, INFINITY);
    const auto look = [&](const float* box, rt_u32 code, float* cost) {
        if (is_leaf(code)) {
            const uint32_t below = BVH2_LEAF_COUNT(code);
            std::fill_n(cost, BVH8_WIDTH, half_area(box, scale) * costs_.primitive * static_cast<float>(below));
            count += below;
            first = std::min(first, BVH2_LEAF_FIRST(code));
        } else {
            const uint32_t below = Decision::count(nodes_[code].pad1);
            std::copy_n(root_costs_[code].cost, BVH8_WIDTH, cost);
            count += below;
            may_be_leaf = may_be_leaf && below > 0;
            first = std::min(first, nodes_[code].pad0);
        }
    };
    look(node.box0, node.child0, left);
    look(node.box1, node.child1, right + bvh2::kRoots);
    may_be_leaf = may_be_leaf && count <= costs_.max_leaf;

    bvh2::SharedRoots shared;
    if (is_leaf(node.child0) && is_leaf(node.child1)) {  // two leaves are two roots, even if more are allowed
        std::fill_n(shared.cost, bvh2::kRoots, left[0] + right[bvh2::kRoots]);
        std::fill_n(shared.left, bvh2::kRoots, 1.0f);
    } else {
        kernels_.share_roots(left, right, shared);
    }

    const float area = half_area(node, scale);
    const float as_node = area * costs_.node + shared.cost[BVH8_WIDTH - 1];
    const float as_leaf = area * costs_.primitive * static_cast<float>(count);
    const bool leaf = may_be_leaf && as_leaf <= as_node;
    rt_u32 bits = more_bits | (may_be_leaf ? count << 21 : 0u) | (leaf ? Decision::kIsLeaf : 0u);
    float* const cost = root_costs_[binary].cost;
    cost[0] = leaf ? as_leaf : as_node;
    for (uint32_t i = 1; i + 1 < BVH8_WIDTH; ++i) {
        const bool better = shared.cost[i] < cost[i - 1];
        cost[i] = better ? shared.cost[i] : cost[i - 1];
        bits |= (better ? static_cast<rt_u32>(shared.left[i]) : 0u) << 3 * (i - 1);
    }
    cost[BVH8_WIDTH - 1] = cost[BVH8_WIDTH - 2];
    node.pad0 = first;
    node.pad1 = bits | static_cast<rt_u32>(shared.left[BVH8_WIDTH - 1]) << 3 * (BVH8_WIDTH - 2);
}

uint32_t Collapse::children(rt_u32 binary, Slot slots[BVH8_WIDTH]) const {
    const bvh2_node& node = nodes_[binary];
    const uint32_t left = Decision::left_of(node.pad1, BVH8_WIDTH);
    Slot* next = slots;
    gather(node.box0, node.child0, left, next);
    gather(node.box1, node.child1, BVH8_WIDTH - left, next);
    return static_cast<uint32_t>(next - slots);
}

void Collapse::gather(const float* box, rt_u32 code, uint32_t roots, Slot*& next) const {
    if (is_leaf(code)) {
        *next++ = {box, BVH8_MAKE_LEAF(BVH2_LEAF_FIRST(code), BVH2_LEAF_COUNT(code)), 0};
        return;
    }
    const bvh2_node& node = nodes_[code];
    while (roots > 1 && Decision::left_of(node.pad1, roots) == 0) --roots;
    if (roots == 1) {
        const bool leaf = node.pad1 & Decision::kIsLeaf;
        *next++ = {box, leaf ? BVH8_MAKE_LEAF(node.pad0, Decision::count(node.pad1)) : BVH8_EMPTY, code};
        return;
    }
    const uint32_t left = Decision::left_of(node.pad1, roots);
    gather(node.box0, node.child0, left, next);
    gather(node.box1, node.child1, roots - left, next);
}

}  // namespace bvh8
