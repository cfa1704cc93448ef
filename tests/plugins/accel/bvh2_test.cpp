// bvh2_test.cpp -- the binned SAH builder: its trees are valid for any input, equal on any machine, and good.
#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstring>

#include "bvh2_check.hpp"

using namespace accel_test;

namespace {

const rt_plugin& bvh2() {
    static const rt_plugin* const plugin = &load("bvh2");
    return *plugin;
}

}  // namespace

TEST(Bvh2, AnEmptyGroupHasANode) {
    const Built built = build(bvh2(), one_group({}));
    const bvh2_node& none = built.slot<bvh2_node>()[built.roots[0]];
    EXPECT_EQ(BVH2_LEAF_COUNT(none.child0), 0u);
    EXPECT_EQ(BVH2_LEAF_COUNT(none.child1), 0u);
}

TEST(Bvh2, BoundsItsDepth) {
    // Each size is a fraction of the one before. The heuristic alone would split them off one by one, and the stack would need
    // an entry for each. There are 30 boxes of each size, because the sizes alone are limited by the exponents of a float.
    const auto shrinking = [](uint32_t i) {
        const float size = std::ldexp(1.0f, 120 - static_cast<int>(i / 30));
        return cube(size, 0, 0, size * 0.5f, i);
    };
    const Input input = one_group(make(30 * 240, shrinking));
    EXPECT_LE(build(bvh2(), input).defines.at("BVH2_STACK"), 72u);
}

TEST(Bvh2, BuildsTheSameTreeWithAnyInstructionSet) {
    for (const char* library : {BVH2_PORTABLE_LIBRARY, BVH2_NO_AVX2_LIBRARY})
        for (const Input& input : {one_group(bumpy_sphere(60000)), one_group(scattered(30000, 1e30f, 0, 2)),
                                   one_group(scattered(3000, 1e-38f, 0, 2)), one_group(scattered(5000, 3e38f, 0, 2))})
            EXPECT_TRUE(same_tree(bvh2(), build(bvh2(), input), build(load("bvh2", library), input))) << library;
}

TEST(Bvh2, ReportsTheCostOfItsTree) {
    Input input;
    input.add_group(bumpy_sphere(50000));
    input.add_group(scattered(3000, 5, 1, 9));
    input.add_group({cube(0, 0, 0, 1, 0)});
    input.add_group({});
    number(input);
    const Built built = build(bvh2(), input);
    EXPECT_NEAR(built.stats.at("sah_cost"), sah_cost(input, built), 1e-9 * sah_cost(input, built));
    const Built weighted = build(bvh2(), input, {{{"traversal_cost", 2.5}, {"intersection_cost", 0.5}}, 2, {}});
    EXPECT_NEAR(weighted.stats.at("sah_cost"), sah_cost(input, weighted, 2.5, 0.5), 1e-6 * sah_cost(input, weighted, 2.5, 0.5));
}

// Compares trees made with bins with the best that the heuristic can find: bins lose almost nothing.

namespace {

struct Bounds {
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    void add(const rt_prim& prim) {
        for (int a = 0; a < 3; ++a) {
            lo[a] = std::min<double>(lo[a], prim.lo[a]);
            hi[a] = std::max<double>(hi[a], prim.hi[a]);
        }
    }
    double area() const {
        const double x = hi[0] - lo[0], y = hi[1] - lo[1], z = hi[2] - lo[2];
        return 2 * (x * y + y * z + z * x);
    }
};

// Returns cost times area of the tree that tries every plane between two primitives, on every axis, in every node. Leaves hold
// up to 4 primitives.
double full_sweep(std::vector<rt_prim>& prims, size_t begin, size_t end) {
    const size_t count = end - begin;
    Bounds whole;
    for (size_t i = begin; i < end; ++i) whole.add(prims[i]);
    double best = INFINITY;
    int best_axis = 0;
    size_t best_left = 0;
    const auto sort = [&](int axis) {
        std::stable_sort(
            prims.begin() + static_cast<long>(begin), prims.begin() + static_cast<long>(end),
            [axis](const rt_prim& a, const rt_prim& b) { return a.lo[axis] + a.hi[axis] < b.lo[axis] + b.hi[axis]; });
    };
    for (int axis = 0; axis < 3 && count > 1; ++axis) {
        sort(axis);
        std::vector<double> left_area(count);
        Bounds left, right;
        for (size_t i = 0; i < count; ++i) {
            left.add(prims[begin + i]);
            left_area[i] = left.area();
        }
        for (size_t i = count - 1; i > 0; --i) {
            right.add(prims[begin + i]);
            const double cost = left_area[i - 1] * static_cast<double>(i) + right.area() * static_cast<double>(count - i);
            if (cost < best) {
                best = cost;
                best_axis = axis;
                best_left = i;
            }
        }
    }
    const double as_leaf = whole.area() * static_cast<double>(count);
    if (count == 1 || (count <= 4 && whole.area() + best >= as_leaf)) return as_leaf;
    sort(best_axis);
    return whole.area() + full_sweep(prims, begin, begin + best_left) + full_sweep(prims, begin + best_left, end);
}

double full_sweep_cost(std::vector<rt_prim> prims) {
    Bounds whole;
    for (const rt_prim& prim : prims) whole.add(prim);
    return full_sweep(prims, 0, prims.size()) / whole.area();
}

}  // namespace

TEST(Bvh2Quality, IsCloseToAFullSweep) {
    for (const std::vector<rt_prim>& prims : {bumpy_sphere(8000), scattered(5000, 1, 0, 6)}) {
        Input input;
        input.add_group(prims);
        const double best = full_sweep_cost(prims);
        EXPECT_LT(build(load("bvh2"), input).stats.at("sah_cost"), 1.03 * best);
        EXPECT_LT(build(load("bvh2"), input, {{{"bins", 8}}, 2, {}}).stats.at("sah_cost"), 1.10 * best);
    }
}

TEST(Bvh2Quality, SplitsALineOfPointsEvenly) {
    // Boxes around points on a line have no surface. Without the padding of areas, every plane would look equally good.
    Input input;
    std::vector<rt_prim> prims;
    for (rt_u32 i = 0; i < 4096; ++i) {
        const float p[3] = {static_cast<float>(i), 0, 0};
        prims.push_back(box_prim(p, p, i));
    }
    input.add_group(prims);
    const Built built = build(load("bvh2"), input);
    EXPECT_EQ(check_bvh2(input, built), "");
    EXPECT_LE(built.stats.at("depth"), 14);  // 2^12 points
}

TEST(Bvh2Quality, SplitsByCountAreEvenAndCostMore) {
    for (const uint32_t count : {1000u, 40000u}) {  // one task, and several levels
        Input input;
        input.add_group(bumpy_sphere(count));
        const Options halves{{{"split", 1}}, 2, {}};
        const Built even = build(load("bvh2"), input, halves), best = build(load("bvh2"), input);
        EXPECT_EQ(check_bvh2(input, even), "");
        EXPECT_EQ(even.stats.at("depth"), std::ceil(std::log2(double(input.prims.size()) / 4)));
        EXPECT_GT(even.stats.at("sah_cost"), 1.02 * best.stats.at("sah_cost"));
        EXPECT_NEAR(even.stats.at("sah_cost"), sah_cost(input, even), 1e-3 * even.stats.at("sah_cost"));
    }
}
