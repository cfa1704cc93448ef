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

void expect_bvh2(const Input& input, const Options& options = {}) {
    const Built built = build(bvh2(), input, options);
    const auto max_leaf = options.params.find("max_leaf");
    EXPECT_EQ(check_bvh2(input, built, max_leaf == options.params.end() ? 4 : static_cast<uint32_t>(max_leaf->second)), "");
}

bool same_tree(const Built& a, const Built& b) {
    return a.leaves == b.leaves && a.roots == b.roots && a.slot_counts == b.slot_counts && a.defines == b.defines &&
           a.stats == b.stats && std::memcmp(a.slots[0], b.slots[0], a.slot_counts[0] * sizeof(bvh2_node)) == 0;
}

}  // namespace

TEST(Bvh2, CoversEveryPrimitiveOnceWithExactBoxes) {
    for (const uint32_t count : {2u, 3u, 4u, 5u, 6u, 7u, 8u, 9u, 31u, 1000u, 16384u, 16385u, 100000u})
        expect_bvh2(one_group(scattered(count, 10, 0, count)));
    expect_bvh2(one_group(bumpy_sphere(200000)));
}

TEST(Bvh2, KeepsToItsParameters) {
    const Input input = one_group(bumpy_sphere(20000));
    for (int max_leaf = 1; max_leaf <= 7; ++max_leaf) expect_bvh2(input, {{{"max_leaf", max_leaf}}, 2, {}});
    for (const int bins : {2, 3, 5, 16, 31, 32}) expect_bvh2(input, {{{"bins", bins}}, 2, {}});
    // The costs determine how large leaves become.
    const Built cheap_nodes = build(bvh2(), input, {{{"traversal_cost", 0.1}, {"max_leaf", 7}}, 2, {}});
    const Built dear_nodes = build(bvh2(), input, {{{"traversal_cost", 10}, {"max_leaf", 7}}, 2, {}});
    EXPECT_GT(cheap_nodes.stats.at("leaves"), 1.5 * dear_nodes.stats.at("leaves"));
}

TEST(Bvh2, GroupsOfFewPrimitivesHaveANode) {
    Input input;
    input.add_group({});
    input.add_group({cube(1, 2, 3, 1, 0)});
    input.add_group({cube(1, 2, 3, 1, 1), cube(1, 2, 3, 1, 2)});
    input.add_group({});
    input.add_group(scattered(500, 1, 0, 1));
    for (size_t i = 0; i < input.prims.size(); ++i) input.prims[i].ref = static_cast<rt_u32>(i);
    expect_bvh2(input);
    expect_bvh2(one_group({}));
    const Built built = build(bvh2(), input);
    const bvh2_node& none = built.slot<bvh2_node>()[built.roots[0]];
    EXPECT_EQ(BVH2_LEAF_COUNT(none.child0), 0u);
    EXPECT_EQ(BVH2_LEAF_COUNT(none.child1), 0u);
}

TEST(Bvh2, BuildsManyGroups) {
    Input input;
    for (uint32_t g = 0; g < 10000; ++g) input.add_group(scattered(g % 50, 1, static_cast<float>(g), g));
    input.add_group(scattered(50000, 1, 0, 7));
    for (size_t i = 0; i < input.prims.size(); ++i) input.prims[i].ref = static_cast<rt_u32>(i);
    expect_bvh2(input);
}

TEST(Bvh2, SplitsPrimitivesThatTheSahCannotSeparate) {
    // All the same box; all the same point; points on a line; boxes around one centre.
    expect_bvh2(one_group(make(100000, [](uint32_t i) { return cube(1, 2, 3, 4, i); })));
    expect_bvh2(one_group(make(100000, [](uint32_t i) { return cube(1, 2, 3, 0, i); })));
    expect_bvh2(one_group(make(50000, [](uint32_t i) { return cube(static_cast<float>(i), 0, 0, 0, i); })));
    expect_bvh2(one_group(make(50000, [](uint32_t i) {
        return cube(-static_cast<float>(i), -static_cast<float>(i), -static_cast<float>(i), 2.0f * static_cast<float>(i), i);
    })));
    // All boxes but one in the same place.
    expect_bvh2(one_group(make(50000, [](uint32_t i) { return cube(i == 77 ? 1e6f : 0.0f, 0, 0, 1, i); })));
}

TEST(Bvh2, BoundsItsDepth) {
    // Each size is a fraction of the one before. The heuristic alone would split them off one by one, and the stack would need
    // an entry for each. There are 30 boxes of each size, because the sizes alone are limited by the exponents of a float.
    const auto shrinking = [](uint32_t i) {
        const float size = std::ldexp(1.0f, 120 - static_cast<int>(i / 30));
        return cube(size, 0, 0, size * 0.5f, i);
    };
    const Input input = one_group(make(30 * 240, shrinking));
    expect_bvh2(input);
    EXPECT_LE(build(bvh2(), input).defines.at("BVH2_STACK"), 72u);
}

TEST(Bvh2, TakesHugeAndTinyCoordinates) {
    for (const float size : {1e-44f, 1e-38f, 1e-30f, 1e-10f, 1e10f, 1e19f, 1e30f, 1e37f, 3e38f})
        expect_bvh2(one_group(scattered(40000, size, 0, 3)));
    // Far from the origin, where neighbouring boxes round to the same coordinates.
    expect_bvh2(one_group(scattered(40000, 1, 1e7f, 3)));
    expect_bvh2(one_group(scattered(40000, 1, 1e9f, 3)));
    // Coordinates over the whole range of a float: centroids and extents overflow.
    expect_bvh2(one_group(make(40000, [](uint32_t i) {
        const float x = FLT_MAX * (static_cast<float>(i % 200) / 100 - 1),
                    y = FLT_MAX * (static_cast<float>(i / 200) / 100 - 1);
        const float lo[3] = {x, y, -FLT_MAX}, hi[3] = {x, y, FLT_MAX};
        return box_prim(lo, hi, i);
    })));
}

TEST(Bvh2, NearlyOverflowingScenesStillGetGoodTrees) {
    const double plain = build(bvh2(), one_group(scattered(20000, 1, 0, 3))).stats.at("sah_cost");
    for (const float size : {1e-30f, 1e25f, 1e37f})
        EXPECT_NEAR(build(bvh2(), one_group(scattered(20000, size, 0, 3))).stats.at("sah_cost"), plain, 0.01 * plain) << size;
}

TEST(Bvh2, BuildsDespiteInvalidBoxes) {
    std::vector<rt_prim> prims = scattered(5000, 1, 0, 5);
    prims[10].lo[0] = NAN;
    prims[20].hi[1] = NAN;
    prims[30].lo[0] = prims[30].hi[0] = INFINITY;
    prims[40].lo[2] = -INFINITY;
    std::swap(prims[50].lo, prims[50].hi);
    const Input input = one_group(prims);
    const Built built = build(bvh2(), input);
    // NaN bounds become the farthest ones, and bounds in the wrong order are swapped.
    Input meant = input;
    meant.prims[10].lo[0] = meant.prims[40].lo[2] = -FLT_MAX;
    meant.prims[20].hi[1] = meant.prims[30].lo[0] = meant.prims[30].hi[0] = FLT_MAX;
    std::swap(meant.prims[50].lo, meant.prims[50].hi);
    EXPECT_EQ(check_bvh2(meant, built), "");
    for (size_t n = 0; n < built.slot_counts[0]; ++n)
        for (int i = 0; i < 6; ++i) {
            ASSERT_TRUE(std::isfinite(built.slot<bvh2_node>()[n].box0[i])) << "node " << n;
            ASSERT_TRUE(std::isfinite(built.slot<bvh2_node>()[n].box1[i])) << "node " << n;
        }
}

TEST(Bvh2, BuildsTheSameTreeOnAnyNumberOfThreads) {
    Input input;
    input.add_group(bumpy_sphere(150000));
    input.add_group(scattered(70000, 5, 1, 9));
    input.add_group(make(40000, [](uint32_t i) { return cube(1, 2, 3, 4, i); }));
    for (uint32_t g = 0; g < 100; ++g) input.add_group(scattered(40, 1, 0, g));
    for (size_t i = 0; i < input.prims.size(); ++i) input.prims[i].ref = static_cast<rt_u32>(i);
    const Built once = build(bvh2(), input, {{}, 1, {}});
    ASSERT_EQ(check_bvh2(input, once), "");
    for (const unsigned threads : {2u, 3u, 8u})
        EXPECT_TRUE(same_tree(once, build(bvh2(), input, {{}, threads, {}}))) << threads;
}

TEST(Bvh2, BuildsTheSameTreeWithAnyInstructionSet) {
    for (const char* library : {BVH2_PORTABLE_LIBRARY, BVH2_NO_AVX2_LIBRARY})
        for (const Input& input : {one_group(bumpy_sphere(60000)), one_group(scattered(30000, 1e30f, 0, 2)),
                                   one_group(scattered(3000, 1e-38f, 0, 2)), one_group(scattered(5000, 3e38f, 0, 2))})
            EXPECT_TRUE(same_tree(build(bvh2(), input), build(load("bvh2", library), input))) << library;
}

TEST(Bvh2, ReportsTheCostOfItsTree) {
    Input input;
    input.add_group(bumpy_sphere(50000));
    input.add_group(scattered(3000, 5, 1, 9));
    input.add_group({cube(0, 0, 0, 1, 0)});
    input.add_group({});
    for (size_t i = 0; i < input.prims.size(); ++i) input.prims[i].ref = static_cast<rt_u32>(i);
    const Built built = build(bvh2(), input);
    EXPECT_NEAR(built.stats.at("sah_cost"), sah_cost(input, built), 1e-9 * sah_cost(input, built));
    const Built weighted = build(bvh2(), input, {{{"traversal_cost", 2.5}, {"intersection_cost", 0.5}}, 2, {}});
    EXPECT_NEAR(weighted.stats.at("sah_cost"), sah_cost(input, weighted, 2.5, 0.5), 1e-6 * sah_cost(input, weighted, 2.5, 0.5));
}

TEST(Bvh2, StopsWhenCancelled) {
    const Input input = one_group(bumpy_sphere(200000));
    int calls = 0;
    float last = 0;
    const Built whole = build(bvh2(), input, {{}, 2, [&](float fraction) {
                                                  EXPECT_GE(fraction, 0.0f);
                                                  EXPECT_LE(fraction, 1.0f);
                                                  last = fraction;
                                                  ++calls;
                                                  return true;
                                              }});
    EXPECT_EQ(whole.status, RT_OK);
    EXPECT_GT(calls, 10);
    EXPECT_GT(last, 0.5f);
    for (const int stop_at : {1, 3, calls / 2, calls - 2}) {
        int n = 0;
        const Built stopped = build(bvh2(), input, {{}, 2, [&](float) { return ++n < stop_at; }});
        EXPECT_EQ(stopped.status, RT_CANCELLED) << "at call " << stop_at << " of " << calls;
        EXPECT_LE(n, stop_at + 8);
    }
}

TEST(Bvh2, ShowsItsLevels) {
    Input input = one_group(bumpy_sphere(5000));
    input.add_group({});
    input.add_group({cube(7, 8, 9, 1, 99999)});
    const Built built = build(bvh2(), input);
    const auto root = volumes(bvh2(), built, 0, 0);
    ASSERT_EQ(root.size(), 1u);
    for (const rt_prim& prim : input.prims) {
        if (prim.ref == 99999) continue;
        for (int a = 0; a < 3; ++a) {
            ASSERT_LE(root[0].lo[a], prim.lo[a]);
            ASSERT_GE(root[0].hi[a], prim.hi[a]);
        }
    }
    EXPECT_EQ(volumes(bvh2(), built, 0, 1).size(), 2u);
    EXPECT_EQ(volumes(bvh2(), built, 0, 3).size(), 8u);
    EXPECT_TRUE(volumes(bvh2(), built, 0, 1000).empty());
    // An empty group has no boxes. The box of a single primitive is root and leaf.
    EXPECT_TRUE(volumes(bvh2(), built, 1, 0).empty());
    EXPECT_TRUE(volumes(bvh2(), built, 1, RT_LEVEL_BOTTOM).empty());
    ASSERT_EQ(volumes(bvh2(), built, 2, 0).size(), 1u);
    EXPECT_EQ(volumes(bvh2(), built, 2, 0)[0].lo[1], 8.0f);
    EXPECT_EQ(volumes(bvh2(), built, 0, RT_LEVEL_BOTTOM).size() + volumes(bvh2(), built, 2, RT_LEVEL_BOTTOM).size(),
              built.stats.at("leaves"));
    EXPECT_THROW(volumes(bvh2(), built, 3, 0), std::runtime_error);
}
