// bvh8_test.cpp -- the collapsed tree: it is valid for any input, equal on any machine, and as cheap as possible.
#include "bvh8_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <random>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "bvh2_types.h"

using namespace accel_test;

namespace {

const rt_plugin& bvh8() {
    static const rt_plugin& plugin = load("bvh8");
    return plugin;
}

double area(const float* box) {
    const double x = double{box[3]} - box[0], y = double{box[4]} - box[1], z = double{box[5]} - box[2];
    return 2 * (x * y + y * z + z * x);
}

// Returns the area of all inner nodes of the usual greedy collapse of a binary tree: the child with the largest area is opened
// until there are eight children.
double greedy_node_area(const bvh2_node* nodes, rt_u32 root) {
    struct Child {
        const float* box;
        rt_u32 code;
    };
    std::vector<Child> children{{nodes[root].box0, nodes[root].child0}, {nodes[root].box1, nodes[root].child1}};
    while (children.size() < 8) {
        auto largest = children.end();
        for (auto c = children.begin(); c != children.end(); ++c)
            if (!(c->code & BVH2_LEAF) && (largest == children.end() || area(c->box) > area(largest->box))) largest = c;
        if (largest == children.end()) break;
        const bvh2_node& node = nodes[largest->code];
        *largest = {node.box0, node.child0};
        children.push_back({node.box1, node.child1});
    }
    double sum = 0;
    for (const Child& child : children)
        if (!(child.code & BVH2_LEAF)) sum += area(child.box) + greedy_node_area(nodes, child.code);
    return sum;
}

double node_area(const bvh8_node* nodes, rt_u32 index) {
    double sum = 0;
    for (int slot = 0; slot < 8; ++slot) {
        if (nodes[index].child[slot] & BVH8_LEAF) continue;
        float box[6];
        for (int k = 0; k < 6; ++k) box[k] = nodes[index].plane[k][slot];
        sum += area(box) + node_area(nodes, nodes[index].child[slot]);
    }
    return sum;
}

}  // namespace

TEST(Bvh8, AnEmptyGroupHasANode) {
    const Built built = build(bvh8(), one_group({}));
    for (const rt_u32 child : built.slot<bvh8_node>()[built.roots[0]].child) EXPECT_EQ(child, BVH8_EMPTY);
}

TEST(Bvh8, TakesAboutAsMuchMemoryAsEmbree) {
    // The baseline, Embree 3.13 in its usual quality, takes 66 bytes a triangle.
    EXPECT_LT(build(bvh8(), one_group(bumpy_sphere(100000))).stats.at("bytes_per_primitive"), 70);
}

TEST(Bvh8, CollapsesNoWorseThanByOpeningTheLargestChild) {
    for (const std::vector<rt_prim>& prims : {bumpy_sphere(30000), scattered(20000, 1, 0, 6)}) {
        const Input input = one_group(prims);
        // Both collapse the same binary tree, with one primitive per leaf, so that they differ in the inner nodes only.
        const Built binary = build(load("bvh2"), input, {{{"max_leaf", 1}}, 2, {}}),
                    wide = build(bvh8(), input, {{{"max_leaf", 1}}, 2, {}});
        ASSERT_EQ(binary.leaves, wide.leaves);
        const double greedy = greedy_node_area(binary.slot<bvh2_node>(), binary.roots[0]),
                     chosen = node_area(wide.slot<bvh8_node>(), wide.roots[0]);
        EXPECT_LT(chosen, 0.99 * greedy);
        EXPECT_GT(chosen, 0.5 * greedy);  // else the two trees would not be comparable
    }
}

TEST(Bvh8, ChildSlotsFollowTheOctants) {
    std::mt19937 random(1);
    for (int turn = 0; turn < 100; ++turn) {
        std::vector<rt_prim> prims = make(8, [&](uint32_t i) {
            const auto at = [&](uint32_t bit) { return (i & bit ? 4.0f : 0.0f) + static_cast<float>(random() % 1000) / 1000; };
            return cube(at(1), at(2), at(4), 1, i);
        });
        std::shuffle(prims.begin(), prims.end(), random);
        const Built built = build(bvh8(), one_group(prims), {{{"max_leaf", 1}}, 2, {}});
        const bvh8_node& node = built.slot<bvh8_node>()[0];
        for (rt_u32 slot = 0; slot < 8; ++slot) EXPECT_EQ(built.leaves[BVH8_LEAF_FIRST(node.child[slot])], slot);
    }
}

TEST(Bvh8, CoincidentBoxesStillFillNodes) {
    const Built built = build(bvh8(), one_group(make(100000, [](uint32_t i) { return cube(1, 2, 3, 4, i); })));
    EXPECT_LE(built.stats.at("depth"), 17);  // halved by count; the minimum would be 5.3
    EXPECT_GT(built.stats.at("children"), 3);
}

#if defined(__SSE2__)
// Embree makes the threads that it has used treat denormal numbers as 0.
TEST(Bvh8, LosesNoPrimitiveWhereDenormalsAreZero) {
    Input input = one_group(make(40, [](uint32_t i) { return cube(float(i % 5) - 2.5f, -0.5f, -0.5f, 1, i); }));
    number(input);
    const unsigned saved = _mm_getcsr();
    _mm_setcsr(saved | 0x8040);
    Options options;
    options.threads = 1;
    EXPECT_EQ(check_bvh8(input, build(bvh8(), input, options)), "");
    _mm_setcsr(saved);
}
#endif
