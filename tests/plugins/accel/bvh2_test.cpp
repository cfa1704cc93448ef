// bvh2_test.cpp -- the binned SAH builder: its trees are valid for any input, equal on any machine, and good.
#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <cstring>

#include "bvh2_check.hpp"

using namespace accel_test;

namespace {

const rt_plugin& bvh2() {
    static const rt_plugin& plugin = load("bvh2");
    return plugin;
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
