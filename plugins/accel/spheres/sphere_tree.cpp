#include "sphere_tree.hpp"

#include <algorithm>
#include <cfloat>

namespace spheres {

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

class ItemTriangles final : public Triangles {
 public:
    ItemTriangles(const Forest& forest, uint32_t first, uint32_t count)
        : items_(forest.items + first), triangles_(forest.triangles), count_(count) {}
    rt_u32 count() const override { return count_; }
    const rt_packed_prim* operator[](rt_u32 i) const override {
        const rt_u32 ref = items_[i].ref;
        return triangles_ && RT_REF_KIND(ref) == RT_REF_TRIANGLE ? triangles_ + RT_REF_INDEX(ref) : nullptr;
    }

 private:
    const Item* const items_;
    const rt_packed_prim* const triangles_;
    const uint32_t count_;
};

void build_node(const Forest& forest, uint32_t first, uint32_t count, uint32_t at, uint32_t depth) {
    Box box;
    for (uint32_t i = first; i < first + count; ++i) box.add(forest.items[i].box);
    spheres_node& node = forest.nodes[at];
    forest.volumes.fit(at, box, ItemTriangles(forest, first, count));
    const uint64_t size = tree_size(forest.rules, count, depth);
    if (size == 1) {
        node.link = first;
        node.count = count;
        return;
    }
    node.link = at + static_cast<uint32_t>(size);
    const int axis = box.longest_axis();
    const uint32_t left = count / 2, right = count - left;
    Item* const items = forest.items + first;
    std::nth_element(items, items + left, items + count,
                     [axis](const Item& a, const Item& b) { return a.box.center(axis) < b.box.center(axis); });
    const uint32_t right_at = at + 1 + static_cast<uint32_t>(tree_size(forest.rules, left, depth + 1));
    const auto child = [&](rt_u32 which) {
        if (which == 0)
            build_node(forest, first, left, at + 1, depth + 1);
        else
            build_node(forest, first + left, right, right_at, depth + 1);
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

void build_tree(const Forest& forest, uint32_t first, uint32_t count, uint32_t at) {
    build_node(forest, first, count, at, 0);
}

}  // namespace spheres
