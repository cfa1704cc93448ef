// wide_test.cpp -- collapsed trees, and compressed ones: they are valid for any input, equal on any machine, and as cheap as
// possible.
#include "wide_check.hpp"

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
#include "bvh8_types.h"

using namespace accel_test;

namespace {

const rt_plugin& bvh8() {
    static const rt_plugin* const plugin = &load("bvh8");
    return *plugin;
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

// The compressed tree: it is bvh8's tree, with boxes that are never too small and hardly larger.

namespace {

const rt_plugin& cwbvh() {
    static const rt_plugin* const plugin = &load("cwbvh");
    return *plugin;
}

// Returns boxes that are spread over a volume of the given size around `at`.
std::vector<rt_prim> spread(uint32_t count, const double at[3], const double size[3]) {
    std::vector<rt_prim> prims = scattered(count, 1, 0, count);
    for (rt_prim& prim : prims)
        for (int a = 0; a < 3; ++a) {
            const float lo = static_cast<float>(at[a] + size[a] * prim.lo[a]),
                        hi = static_cast<float>(at[a] + size[a] * prim.hi[a]);
            prim.lo[a] = std::min(lo, hi);
            prim.hi[a] = std::max(lo, hi);
        }
    return prims;
}

}  // namespace

// Grids at every scale and position. Tiny boxes far from the origin get cells finer than their coordinates, flat boxes get
// cells of almost no extent, and the largest floats make an axis without a grid.
TEST(Cwbvh, GridsAtEveryScale) {
    for (const double size : {1e-35, 1e-20, 1e-3, 1.0, 1e10, 1e30, 1e37})
        for (const double at : {0.0, 1e-30, -1.0, 12345.678, -1e20, 3e37})
            for (const double flat : {0.0, 1e-6, 1.0}) {
                const double place[3] = {at, -at, 0.5 * at}, sides[3] = {size, size * flat, size};
                const Input input = one_group(spread(300, place, sides));
                EXPECT_EQ(check_cwbvh(input, build(cwbvh(), input)), "") << size << " at " << at << ", flat " << flat;
            }
    const float lo[3] = {-FLT_MAX, -FLT_MAX, -1}, hi[3] = {FLT_MAX, 1, 1};
    const Input one = one_group({box_prim(lo, hi, 0)});
    EXPECT_EQ(check_cwbvh(one, build(cwbvh(), one)), "");
}

// The compressed tree takes 55 bytes a triangle where bvh8 takes 68, and has the same order of octants.
TEST(Cwbvh, IsTheTreeOfBvh8) {
    const Input input = one_group(bumpy_sphere(100000));
    const Options same_costs{{{"max_leaf", 4}, {"intersection_cost", 1}}, 2, {}};
    const Built wide = build(load("bvh8"), input, same_costs), compressed = build(cwbvh(), input, same_costs);
    EXPECT_EQ(wide.slot_counts[0], compressed.slot_counts[0]);
    EXPECT_EQ(wide.stats.at("sah_cost"), compressed.stats.at("sah_cost"));
    EXPECT_LT(compressed.stats.at("bytes_per_primitive"), 57);
    const bvh8_node& root = wide.slot<bvh8_node>()[wide.roots[0]];
    const cwbvh_node& same = compressed.slot<cwbvh_node>()[compressed.roots[0]];
    for (uint32_t slot = 0; slot < 8; ++slot) {
        EXPECT_EQ((root.child[slot] & BVH8_LEAF) == 0, (same.cells >> (24 + slot) & 1u) != 0);
        EXPECT_EQ(BVH8_LEAF_COUNT(root.child[slot]) > 0 && (root.child[slot] & BVH8_LEAF) != 0,
                  (same.primitives >> 4 * slot & 15u) != 0);
    }
}

// The cost of rounding the planes to bytes, as the area of all leaf boxes; rays hit boxes in proportion to it.
TEST(Cwbvh, QuantizedBoxesAreHardlyWider) {
    const Input input = one_group(bumpy_sphere(50000));
    const Options same_costs{{{"max_leaf", 4}, {"intersection_cost", 1}}, 2, {}};
    const Built wide = build(load("bvh8"), input, same_costs), compressed = build(cwbvh(), input, same_costs);
    const auto area = [&](const rt_plugin& plugin, const Built& built) {
        double sum = 0;
        for (const Volume& box : volumes(plugin, built, 0, RT_LEVEL_BOTTOM)) {
            const double x = double{box.hi[0]} - box.lo[0], y = double{box.hi[1]} - box.lo[1],
                         z = double{box.hi[2]} - box.lo[2];
            sum += x * y + y * z + z * x;
        }
        return sum;
    };
    const double exact = area(load("bvh8"), wide), rounded = area(cwbvh(), compressed);
    EXPECT_GT(rounded, exact);
    EXPECT_LT(rounded, 1.1 * exact);
}
