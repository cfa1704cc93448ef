// bvh2_quality_test.cpp -- compares trees made with bins with the best that the heuristic can find: bins lose almost nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bvh2_check.hpp"

using namespace accel_test;

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
