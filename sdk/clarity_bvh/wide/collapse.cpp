#include "clarity_bvh/wide/collapse.hpp"

#include <algorithm>
#include <cmath>

namespace clarity::bvh {
namespace {

// Half area of the box around both children.
float half_area(const Node& node, float scale) {
    return half_area(min(load_any(node.box1), load_any(node.box0)), max(load_any(node.box1 + 3), load_any(node.box0 + 3)),
                     scale);
}

}  // namespace

template <uint32_t Width>
void Collapse<Width>::decide_part(const Part& part) const {
    for (uint32_t i = part.first_node + part.node_count; i-- > part.first_node;) decide(i, part.scale, 0);
}

template <uint32_t Width>
void Collapse<Width>::decide_tops(const Topology& topology) const {
    for (size_t i = topology.tops.size(); i-- > 0;) decide(topology.tops[i].node, topology.tops[i].scale, Decision::kIsTop);
}

template <uint32_t Width>
void Collapse<Width>::decide(uint32_t binary, float scale, uint32_t more_bits) const {
    static_assert(kRoots >= Width, "roots become children");
    Node& node = nodes_[binary];
    float left[kRoots] = {}, right[2 * kRoots] = {};  // entries from Width on are not read
    uint32_t count = 0;
    uint32_t first = RT_NONE;
    bool may_be_leaf = true;
    std::fill_n(right, kRoots, INFINITY);
    const auto look = [&](const float* box, uint32_t code, float* cost) {
        if (is_leaf(code)) {
            const uint32_t below = leaf_count(code);
            std::fill_n(cost, Width, half_area(box, scale) * costs_.primitive * static_cast<float>(below));
            count += below;
            first = std::min(first, leaf_first(code));
        } else {
            const uint32_t below = Decision::primitives(nodes_[code].work1);
            std::copy_n(root_costs_[code].cost, Width, cost);
            count += below;
            may_be_leaf = may_be_leaf && below > 0;
            first = std::min(first, nodes_[code].work0);
        }
    };
    look(node.box0, node.child0, left);
    look(node.box1, node.child1, right + kRoots);
    may_be_leaf = may_be_leaf && count <= costs_.max_leaf;

    SharedRoots shared;
    if (is_leaf(node.child0) && is_leaf(node.child1)) {  // two leaves are two roots, even if more are allowed
        std::fill_n(shared.cost, kRoots, left[0] + right[kRoots]);
        std::fill_n(shared.left, kRoots, 1.0f);
    } else {
        kernels_.share_roots(left, right, shared);
    }

    const float area = half_area(node, scale);
    const float as_node = area * costs_.node + shared.cost[Width - 1];
    const float as_leaf = area * costs_.primitive * static_cast<float>(count);
    const bool leaf = may_be_leaf && as_leaf <= as_node;
    uint32_t bits = more_bits | (may_be_leaf ? count << 21 : 0u) | (leaf ? Decision::kIsLeaf : 0u);
    float* const cost = root_costs_[binary].cost;
    cost[0] = leaf ? as_leaf : as_node;
    for (uint32_t i = 1; i + 1 < Width; ++i) {
        const bool better = shared.cost[i] < cost[i - 1];
        cost[i] = better ? shared.cost[i] : cost[i - 1];
        bits |= (better ? static_cast<uint32_t>(shared.left[i]) : 0u) << 3 * (i - 1);
    }
    cost[Width - 1] = cost[Width - 2];
    node.work0 = first;
    node.work1 = bits | static_cast<uint32_t>(shared.left[Width - 1]) << 3 * (Width - 2);
}

template <uint32_t Width>
uint32_t Collapse<Width>::children(uint32_t binary, Slot slots[Width]) const {
    const Node& node = nodes_[binary];
    const uint32_t left = Decision::left_of(node.work1, Width);
    Slot* next = slots;
    gather(node.box0, node.child0, left, next);
    gather(node.box1, node.child1, Width - left, next);
    return static_cast<uint32_t>(next - slots);
}

template <uint32_t Width>
void Collapse<Width>::gather(const float* box, uint32_t code, uint32_t roots, Slot*& next) const {
    if (is_leaf(code)) {
        *next++ = {box, make_leaf(leaf_first(code), leaf_count(code)), 0};
        return;
    }
    const Node& node = nodes_[code];
    while (roots > 1 && Decision::left_of(node.work1, roots) == 0) --roots;
    if (roots == 1) {
        const bool leaf = node.work1 & Decision::kIsLeaf;
        *next++ = {box, leaf ? make_leaf(node.work0, Decision::primitives(node.work1)) : kEmpty, code};
        return;
    }
    const uint32_t left = Decision::left_of(node.work1, roots);
    gather(node.box0, node.child0, left, next);
    gather(node.box1, node.child1, roots - left, next);
}

template class Collapse<4>;
template class Collapse<8>;

}  // namespace clarity::bvh
