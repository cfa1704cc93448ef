// sorted_run.hpp -- builds the binary tree of sorted primitives in one sweep.
#pragma once
#include "clarity_bvh/build/morton.hpp"
#include "clarity_bvh/topology.hpp"

namespace clarity::bvh {

// A finished subtree without a parent so far.
struct SortedSubtree {
    Vec4 lo, neg_hi;
    rt_u32 code;     // child code; RT_NONE: at most max_leaf primitives, which may still join a larger leaf
    uint32_t begin;  // index of its first primitive in the run
    uint32_t depth;  // number of nodes on the path to the deepest leaf
};

inline void set_child(Node& node, int which, Vec4 lo, Vec4 neg_hi, rt_u32 code) {
    float* const out = which == 0 ? node.box0 : node.box1;
    alignas(16) float hi[4];
    store(hi, splat(0.0f) - neg_hi);
    store_any(out, lo);
    std::memcpy(out + 3, hi, 3 * sizeof hi[0]);
    (which == 0 ? node.child0 : node.child1) = code;
    (which == 0 ? node.work0 : node.work1) = 0;
}

// Builds the tree of a run. Writes the refs to `refs`, and the nodes from nodes[0] on, children before parents. Up to max_leaf
// primitives become one leaf. Returns the root, and the number of nodes in node_count.
//
// The tree is the Cartesian tree of the differences between neighbouring keys: a node splits where neighbouring keys differ in
// the highest bit. Each subtree stays on a stack, with the difference between its last key and the next one, until a difference
// in a higher bit follows. Keys with equal positions differ by their index in the run, so such primitives are split into nearly
// even halves.
inline SortedSubtree sweep(const MortonKey* keys, uint32_t count, const rt_prim* prims, uint32_t first_leaf, uint32_t max_leaf,
                           rt_u32* refs, Node* nodes, uint32_t& node_count) {
    constexpr uint32_t kAhead = 16;
    struct Waiting {
        SortedSubtree tree;
        uint64_t differs;  // difference (xor) between its last key and the next key
    } stack[Curve::kMaxBits + kPositionBits + 2];
    uint32_t height = 0, made = 0;
    const auto finish = [&](SortedSubtree& tree, uint32_t end) {
        if (tree.code != RT_NONE) return;
        tree.code = make_leaf(first_leaf + tree.begin, end - tree.begin);
        tree.depth = 0;
    };
    SortedSubtree at{};
    for (uint32_t i = 0; i < count; ++i) {
        fetch(prims + position(keys[std::min(i + kAhead, count - 1)]));
        const rt_prim& prim = prims[position(keys[i])];
        refs[i] = prim.ref;
        sound_box(prim, at.lo, at.neg_hi);
        at.code = RT_NONE;
        at.begin = i;
        uint64_t differs = ~uint64_t{0};
        if (i + 1 < count) differs = (keys[i] ^ keys[i + 1]) >> kPositionBits << kPositionBits | (i ^ (i + 1));
        while (height > 0 && stack[height - 1].differs < differs) {
            SortedSubtree& left = stack[--height].tree;
            const Vec4 lo = min(left.lo, at.lo), neg_hi = min(left.neg_hi, at.neg_hi);
            if (i + 1 - left.begin > max_leaf) {
                finish(left, at.begin);
                finish(at, i + 1);
                set_child(nodes[made], 0, left.lo, left.neg_hi, left.code);
                set_child(nodes[made], 1, at.lo, at.neg_hi, at.code);
                at.code = made++;
                at.depth = std::max(left.depth, at.depth) + 1;
            }
            at.begin = left.begin;
            at.lo = lo;
            at.neg_hi = neg_hi;
        }
        stack[height++] = {at, differs};
    }
    finish(at, count);
    node_count = made;
    return at;
}

}  // namespace clarity::bvh
