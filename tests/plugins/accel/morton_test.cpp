// morton_test.cpp -- the fast builder: its trees are valid for any input, follow the curve, and are equal on any machine.
#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <cstring>

#include "bvh2_check.hpp"
#include "wide_check.hpp"

using namespace accel_test;

namespace {

constexpr double kMorton = 1;  // value of the parameter `builder`

Options fast(double max_leaf = 4, unsigned threads = 2) {
    return {{{"builder", kMorton}, {"max_leaf", max_leaf}}, threads, {}};
}

void expect_morton(const std::vector<rt_prim>& prims, double max_leaf = 4) {
    Input input;
    input.add_group(prims);
    EXPECT_EQ(check_bvh2(input, build(load("bvh2"), input, fast(max_leaf)), static_cast<uint32_t>(max_leaf), false), "");
    EXPECT_EQ(check_bvh8(input, build(load("bvh8"), input, fast(max_leaf)), static_cast<uint32_t>(max_leaf)), "");
}

std::vector<rt_prim> same_box(uint32_t count, float size) {
    const float lo[3] = {1, 2, 3}, hi[3] = {1 + size, 2 + size, 3 + size};
    std::vector<rt_prim> prims;
    for (rt_u32 i = 0; i < count; ++i) prims.push_back(box_prim(lo, hi, i));
    return prims;
}

bool same_leaves_and_nodes(const Built& a, const Built& b, size_t node_bytes) {
    return a.leaves == b.leaves && a.roots == b.roots && a.slot_counts == b.slot_counts && a.stats == b.stats &&
           std::memcmp(a.slots[0], b.slots[0], a.slot_counts[0] * node_bytes) == 0;
}

}  // namespace

TEST(Morton, CoversEveryPrimitiveOnceWithExactBoxes) {
    for (const uint32_t count : {1u, 2u, 3u, 4u, 5u, 8u, 9u, 31u, 1000u, 16384u, 16385u, 100000u})
        expect_morton(scattered(count, 10, 0, count));
    for (const double max_leaf : {1, 2, 7}) expect_morton(bumpy_sphere(60000), max_leaf);
    expect_morton({});
}

TEST(Morton, BuildsForTinyAndHugeExtents) {
    expect_morton(same_box(50000, 4));
    expect_morton(same_box(50000, 0));
    for (const float size : {1e-44f, 1e-38f, 1e-20f, 1e20f, 1e37f, 3e38f}) expect_morton(scattered(20000, size, 0, 3));
    expect_morton(scattered(20000, 1, 1e9f, 3));
    std::vector<rt_prim> line;
    for (rt_u32 i = 0; i < 30000; ++i) {
        const float p[3] = {FLT_MAX * (static_cast<float>(i) / 15000 - 1), 0, 0};
        line.push_back(box_prim(p, p, i));
    }
    expect_morton(line);
}

TEST(Morton, LeavesFollowTheMortonCurve) {
    // Cubes on a grid of 8 x 8 x 8. The curve visits one octant after the other.
    std::vector<rt_prim> prims;
    for (rt_u32 i = 0; i < 512; ++i) {
        const float lo[3] = {static_cast<float>(i % 8), static_cast<float>(i / 8 % 8), static_cast<float>(i / 64)},
                    hi[3] = {lo[0] + 0.5f, lo[1] + 0.5f, lo[2] + 0.5f};
        prims.push_back(box_prim(lo, hi, i));
    }
    Input input;
    input.add_group(prims);
    const Built built = build(load("bvh2"), input, fast(1));
    const auto octant = [](rt_u32 ref) { return (ref % 8 / 4) << 2 | (ref / 8 % 8 / 4) << 1 | ref / 64 / 4; };
    for (rt_u32 i = 0; i < 512; ++i) EXPECT_EQ(octant(built.leaves[i]), i / 64) << "position " << i;
}

TEST(Morton, CutsTheLongestSideOfACellFirst) {
    // 4 x 4 rows of 32 cubes. The first three cuts go across the rows. So each eighth of the leaf order holds one eighth of all
    // rows.
    std::vector<rt_prim> prims;
    for (rt_u32 i = 0; i < 512; ++i) {
        const float lo[3] = {static_cast<float>(i / 32 % 4), static_cast<float>(i % 32), static_cast<float>(i / 128)},
                    hi[3] = {lo[0] + 0.5f, lo[1] + 0.5f, lo[2] + 0.5f};
        prims.push_back(box_prim(lo, hi, i));
    }
    Input input;
    input.add_group(prims);
    const Built built = build(load("bvh2"), input, fast(1));
    for (rt_u32 i = 0; i < 512; ++i) EXPECT_EQ(built.leaves[i] % 32 / 4, i / 64) << "position " << i;
}

TEST(Morton, ASmallMeshInALargeSceneIsSubdividedToo) {
    // All of the sphere is in one cell of the scene's curve. Its leaves must be as small as in a scene of its own.
    const std::vector<rt_prim> sphere = bumpy_sphere(60000);
    std::vector<rt_prim> stadium = sphere;
    for (const float at : {-3e6f, 5e6f}) {
        const float p[3] = {at, at, at};
        stadium.push_back(box_prim(p, p, static_cast<rt_u32>(stadium.size())));
    }
    const auto sides_of_leaves = [&](const std::vector<rt_prim>& prims) {
        Input input;
        input.add_group(prims);
        const Built built = build(load("bvh2"), input, fast());
        EXPECT_EQ(check_bvh2(input, built, 4, false), "");
        std::vector<rt_u32> refs;
        for (const rt_u32 ref : built.leaves)
            if (ref < sphere.size()) refs.push_back(ref);
        double sum = 0;
        for (size_t i = 0; i + 4 <= refs.size(); i += 4)
            for (int a = 0; a < 3; ++a) {
                float lo = INFINITY, hi = -INFINITY;
                for (size_t k = i; k < i + 4; ++k) {
                    lo = std::min(lo, prims[refs[k]].lo[a]);
                    hi = std::max(hi, prims[refs[k]].hi[a]);
                }
                sum += hi - lo;
            }
        return sum;
    };
    EXPECT_LT(sides_of_leaves(stadium), 1.2 * sides_of_leaves(sphere));
}

TEST(Morton, LimitsTheDepth) {
    // Nested clusters, each in one cell of the curve of the cluster around it.
    std::vector<rt_prim> prims;
    for (int level = 0; level < 30; ++level)
        for (rt_prim prim : scattered(5000, std::pow(16.0f, static_cast<float>(-level)), 0, static_cast<uint32_t>(level))) {
            prim.ref = static_cast<rt_u32>(prims.size());
            prims.push_back(prim);
        }
    expect_morton(prims);
    Input input;
    input.add_group(prims);
    EXPECT_LE(build(load("bvh2"), input, fast()).stats.at("depth"), 64);
}

TEST(Morton, BuildsManyGroups) {
    Input input;
    for (uint32_t g = 0; g < 3000; ++g) input.add_group(scattered(g % 50, 1, static_cast<float>(g), g));
    input.add_group(scattered(50000, 1, 0, 7));
    number(input);
    EXPECT_EQ(check_bvh2(input, build(load("bvh2"), input, fast()), 4, false), "");
    EXPECT_EQ(check_bvh8(input, build(load("bvh8"), input, fast()), 4), "");
}

TEST(Morton, BuildsTheSameTreeOnAnyMachine) {
    Input input;
    input.add_group(bumpy_sphere(120000));
    input.add_group(scattered(70000, 5, 1, 9));
    number(input);
    const Built once = build(load("bvh2"), input, fast(4, 1)), wide = build(load("bvh8"), input, fast(4, 1));
    for (const unsigned threads : {2u, 8u}) {
        EXPECT_TRUE(same_leaves_and_nodes(once, build(load("bvh2"), input, fast(4, threads)), sizeof(bvh2_node))) << threads;
        EXPECT_TRUE(same_leaves_and_nodes(wide, build(load("bvh8"), input, fast(4, threads)), sizeof(bvh8_node))) << threads;
    }
    for (const char* library : {BVH2_PORTABLE_LIBRARY, BVH2_NO_AVX2_LIBRARY})
        EXPECT_TRUE(same_leaves_and_nodes(once, build(load("bvh2", library), input, fast()), sizeof(bvh2_node))) << library;
}

TEST(Morton, SahCostIsLessThanTwiceTheSahBuilders) {
    Input input;
    input.add_group(bumpy_sphere(50000));
    for (const char* id : {"bvh2", "bvh8"}) {
        const double best = build(load(id), input).stats.at("sah_cost"),
                     found = build(load(id), input, fast()).stats.at("sah_cost");
        EXPECT_GT(found, 1.02 * best) << id;
        EXPECT_LT(found, 1.5 * best) << id;
    }
}

TEST(Morton, StopsWhenCancelled) {
    Input input;
    input.add_group(bumpy_sphere(200000));
    for (const int stop_at : {1, 2, 5}) {
        int n = 0;
        Options options = fast();
        options.progress = [&](float) { return ++n < stop_at; };
        EXPECT_EQ(build(load("bvh8"), input, options).status, RT_CANCELLED) << stop_at;
    }
}
