// cwbvh_test.cpp -- the compressed tree: it is bvh8's tree, with boxes that are never too small and hardly larger.
#include "cwbvh_check.hpp"

#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <cstring>

#include "bvh8_types.h"

using namespace accel_test;

namespace {

const rt_plugin& cwbvh() {
    static const rt_plugin& plugin = load("cwbvh");
    return plugin;
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
