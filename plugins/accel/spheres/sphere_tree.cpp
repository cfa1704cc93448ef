#include "sphere_tree.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

namespace spheres {

Box::Box() : lo{FLT_MAX, FLT_MAX, FLT_MAX}, hi{-FLT_MAX, -FLT_MAX, -FLT_MAX} {}

void Box::add(const Box& other) {
    for (int axis = 0; axis < 3; ++axis) {
        lo[axis] = std::min(lo[axis], other.lo[axis]);
        hi[axis] = std::max(hi[axis], other.hi[axis]);
    }
}

int Box::longest_axis() const {
    int longest = 0;
    for (int axis = 1; axis < 3; ++axis)
        if (double{hi[axis]} - lo[axis] > double{hi[longest]} - lo[longest]) longest = axis;
    return longest;
}

Item make_item(const rt_prim& prim) {
    Item item;
    item.ref = prim.ref;
    for (int axis = 0; axis < 3; ++axis) {
        // NaN becomes the farthest bound and infinite bounds are clamped, so no part of the primitive is lost.
        const float lo = prim.lo[axis] >= -FLT_MAX ? std::min(prim.lo[axis], FLT_MAX) : -FLT_MAX;
        const float hi = prim.hi[axis] <= FLT_MAX ? std::max(prim.hi[axis], -FLT_MAX) : FLT_MAX;
        item.box.lo[axis] = std::min(lo, hi);
        item.box.hi[axis] = std::max(lo, hi);
    }
    return item;
}

namespace {

bool is_leaf(const Rules& rules, uint64_t count, uint32_t depth) {
    return count <= rules.max_leaf || depth >= rules.max_depth;
}

// The sizes of the trees over n and n + 1 items. Every subtree has one of two such sizes as well.
struct Sizes {
    uint64_t of_n, of_next;
};
Sizes tree_sizes(const Rules& rules, uint64_t n, uint32_t depth) {
    const bool leaf = is_leaf(rules, n, depth), next_leaf = is_leaf(rules, n + 1, depth);
    if (leaf && next_leaf) return {1, 1};
    const Sizes half = tree_sizes(rules, n / 2, depth + 1);  // over floor(n / 2) and one more
    const bool odd = n % 2 != 0;
    const uint64_t split = odd ? 1 + half.of_n + half.of_next : 1 + 2 * half.of_n;
    const uint64_t next_split = odd ? 1 + 2 * half.of_next : 1 + half.of_n + half.of_next;
    return {leaf ? 1 : split, next_leaf ? 1 : next_split};
}

constexpr uint32_t kParallel = 16384;  // smallest number of items for which two threads build the halves

void build_node(const Forest& forest, uint32_t first, uint32_t count, uint32_t at, uint32_t level, uint32_t depth) {
    Box box;
    for (uint32_t i = first; i < first + count; ++i) box.add(forest.items[i].box);
    spheres_node& node = forest.nodes[at];
    set_sphere(node, box);
    node.level = level;
    const uint64_t size = tree_size(forest.rules, count, depth);
    node.skip = at + static_cast<uint32_t>(size);
    if (size == 1) {
        node.first = first;
        node.count = count;
        return;
    }
    const int axis = box.longest_axis();
    const uint32_t left = count / 2, right = count - left;
    Item* const items = forest.items + first;
    std::nth_element(items, items + left, items + count,
                     [axis](const Item& a, const Item& b) { return a.box.center(axis) < b.box.center(axis); });
    const uint32_t right_at = at + 1 + static_cast<uint32_t>(tree_size(forest.rules, left, depth + 1));
    const auto child = [&](rt_u32 which) {
        if (which == 0)
            build_node(forest, first, left, at + 1, level + 1, depth + 1);
        else
            build_node(forest, first + left, right, right_at, level + 1, depth + 1);
    };
    if (count >= kParallel) {
        rt::progress(forest.host, 0.5f);  // the true progress is unknown; the call is here to notice a cancelled build
        rt::parallel_for(forest.host, 2, child);
    } else {
        child(0);
        child(1);
    }
}

}  // namespace

uint64_t tree_size(const Rules& rules, uint64_t count, uint32_t depth) {
    return tree_sizes(rules, count, depth).of_n;
}

void set_sphere(spheres_node& node, const Box& box) {
    double square = 0;
    for (int axis = 0; axis < 3; ++axis) {
        node.center[axis] = box.center(axis);
        const double half = std::max(double{box.hi[axis]} - node.center[axis], node.center[axis] - double{box.lo[axis]});
        square += half * half;
    }
    const double radius = std::sqrt(square) * (1 + 4 * DBL_EPSILON);
    node.radius = static_cast<float>(radius);
    if (node.radius < radius) node.radius = std::nextafter(node.radius, INFINITY);
}

void build_tree(const Forest& forest, uint32_t first, uint32_t count, uint32_t at, uint32_t level) {
    build_node(forest, first, count, at, level, 0);
}

}  // namespace spheres
