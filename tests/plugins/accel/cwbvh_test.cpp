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

Input numbered_group(const std::vector<rt_prim>& prims) {
    Input input = one_group(prims);
    for (size_t i = 0; i < input.prims.size(); ++i) input.prims[i].ref = static_cast<rt_u32>(i);
    return input;
}

void expect_cwbvh(const Input& input, const Options& options = {}) {
    const auto leaf = options.params.find("max_leaf");
    EXPECT_EQ(check_cwbvh(input, build(cwbvh(), input, options),
                          leaf == options.params.end() ? 4 : static_cast<uint32_t>(leaf->second)),
              "");
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

TEST(Cwbvh, HoldsEveryPrimitiveOnce) {
    for (const uint32_t count : {1u, 2u, 3u, 4u, 5u, 8u, 9u, 31u, 65u, 1000u, 16385u, 100000u})
        expect_cwbvh(numbered_group(scattered(count, 10, 0, count)));
    expect_cwbvh(numbered_group(bumpy_sphere(200000)));
    for (int max_leaf = 1; max_leaf <= 4; ++max_leaf)
        expect_cwbvh(numbered_group(bumpy_sphere(5000)), {{{"max_leaf", max_leaf}}, 2, {}});
    expect_cwbvh(numbered_group(bumpy_sphere(20000)), {{{"builder", 1}}, 2, {}});
}

TEST(Cwbvh, GroupsOfFewPrimitivesHaveANode) {
    Input input;
    input.add_group({});
    for (uint32_t g = 0; g < 3000; ++g) input.add_group(scattered(g % 40, 1, static_cast<float>(g), g));
    input.add_group(scattered(20000, 1, 0, 7));
    for (size_t i = 0; i < input.prims.size(); ++i) input.prims[i].ref = static_cast<rt_u32>(i);
    expect_cwbvh(input);
    expect_cwbvh(numbered_group({}));
}

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
    expect_cwbvh(numbered_group({box_prim(lo, hi, 0)}));
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

TEST(Cwbvh, BuildsTheSameTreeOnAnyNumberOfThreads) {
    const Input input = one_group(bumpy_sphere(60000));
    const Built one = build(cwbvh(), input, {{}, 1, {}}), four = build(cwbvh(), input, {{}, 4, {}});
    EXPECT_EQ(one.leaves, four.leaves);
    ASSERT_EQ(one.slot_counts, four.slot_counts);
    EXPECT_EQ(std::memcmp(one.slots[0], four.slots[0], one.slot_counts[0] * sizeof(cwbvh_node)), 0);
}
