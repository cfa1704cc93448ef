// builders_test.cpp -- what all builders by the surface area heuristic promise: their trees are valid for any input, equal for
// any number of threads, and good. Files beside this one test what only one of them does.
#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <cstring>

#include "bvh2_check.hpp"
#include "harness.hpp"
#include "linear_types.h"
#include "wide_check.hpp"

using namespace accel_test;

namespace {

double param(const Options& options, const char* key, double otherwise) {
    const auto found = options.params.find(key);
    return found == options.params.end() ? otherwise : found->second;
}

uint32_t leaf_limit(const Options& options, double otherwise) {
    return static_cast<uint32_t>(param(options, "max_leaf", otherwise));
}
std::string bvh2_faults(const Input& input, const Built& built, const Options& options) {
    const bool binned = param(options, "builder", 0) == 0;  // these alone have the larger child first
    return check_bvh2(input, built, leaf_limit(options, 4), binned);
}
std::string bvh8_faults(const Input& input, const Built& built, const Options& options) {
    return check_bvh8(input, built, leaf_limit(options, 7), param(options, "traversal_cost", 3),
                      param(options, "intersection_cost", 0.4));
}
std::string cwbvh_faults(const Input& input, const Built& built, const Options& options) {
    return check_cwbvh(input, built, leaf_limit(options, 4));
}

struct Builder {
    const char* id;
    uint32_t width;    // children of a node
    int leaf_max;      // the greatest max_leaf
    bool exact_boxes;  // not rounded to a grid
    std::string (*faults)(const Input&, const Built&, const Options&);
};
const Builder kBuilders[] = {
    {"bvh2", 2, 7, true, bvh2_faults}, {"bvh8", 8, 7, true, bvh8_faults}, {"cwbvh", 8, 4, false, cwbvh_faults}};

class Builders : public testing::TestWithParam<Builder> {
 protected:
    const rt_plugin& plugin() const { return load(GetParam().id); }
    Built built(const Input& input, const Options& options = {}) const { return build(plugin(), input, options); }
    void expect_sound(const Input& input, const Options& options = {}) const {
        EXPECT_EQ(GetParam().faults(input, built(input, options), options), "");
    }
};
INSTANTIATE_TEST_SUITE_P(All, Builders, testing::ValuesIn(kBuilders),
                         [](const testing::TestParamInfo<Builder>& info) { return info.param.id; });

}  // namespace

TEST_P(Builders, HoldEveryPrimitiveOnceInExactBoxes) {
    for (const uint32_t count : {1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u, 9u, 31u, 64u, 65u, 1000u, 16384u, 16385u, 100000u})
        expect_sound(one_group(scattered(count, 10, 0, count)));
    expect_sound(one_group(bumpy_sphere(200000)));
}

TEST_P(Builders, KeepToTheirParameters) {
    const Input input = one_group(bumpy_sphere(20000));
    for (int max_leaf = 1; max_leaf <= GetParam().leaf_max; ++max_leaf) {
        expect_sound(input, {{{"max_leaf", max_leaf}}, 2, {}});
        expect_sound(input, {{{"max_leaf", max_leaf}, {"traversal_cost", 100}}, 2, {}});
    }
    for (const int bins : {2, 3, 5, 16, 31, 32}) expect_sound(input, {{{"bins", bins}}, 2, {}});
    expect_sound(input, {{{"builder", 1}}, 2, {}});
    expect_sound(input, {{{"reinsert", 4}}, 2, {}});
    expect_sound(input, {{{"traversal_cost", 2.5}, {"intersection_cost", 0.5}}, 2, {}});
    // The costs determine how large leaves become.
    const double leaf = GetParam().leaf_max;
    const Built cheap_nodes = built(input, {{{"traversal_cost", 0.1}, {"max_leaf", leaf}}, 2, {}});
    const Built dear_nodes = built(input, {{{"traversal_cost", 10}, {"max_leaf", leaf}}, 2, {}});
    EXPECT_GT(cheap_nodes.stats.at("leaves"), 1.5 * dear_nodes.stats.at("leaves"));
}

TEST_P(Builders, GiveGroupsOfFewPrimitivesANode) {
    Input input;
    input.add_group({});
    input.add_group({cube(1, 2, 3, 1, 0)});
    input.add_group({cube(1, 2, 3, 1, 1), cube(1, 2, 3, 1, 2)});
    input.add_group({});
    input.add_group(scattered(500, 1, 0, 1));
    number(input);
    expect_sound(input);
    expect_sound(one_group({}));
}

TEST_P(Builders, BuildManyGroups) {
    Input input;
    for (uint32_t g = 0; g < 10000; ++g) input.add_group(scattered(g % 50, 1, static_cast<float>(g), g));
    input.add_group(scattered(50000, 1, 0, 7));
    number(input);
    expect_sound(input);
}

TEST_P(Builders, SplitPrimitivesThatTheSahCannotSeparate) {
    // All the same box; all the same point; points on a line; boxes around one centre; all but one in the same place.
    expect_sound(one_group(make(100000, [](uint32_t i) { return cube(1, 2, 3, 4, i); })));
    expect_sound(one_group(make(100000, [](uint32_t i) { return cube(1, 2, 3, 0, i); })));
    expect_sound(one_group(make(50000, [](uint32_t i) { return cube(static_cast<float>(i), 0, 0, 0, i); })));
    expect_sound(one_group(make(50000, [](uint32_t i) {
        return cube(-static_cast<float>(i), -static_cast<float>(i), -static_cast<float>(i), 2.0f * static_cast<float>(i), i);
    })));
    expect_sound(one_group(make(50000, [](uint32_t i) { return cube(i == 77 ? 1e6f : 0.0f, 0, 0, 1, i); })));
    // Each size is a fraction of the one before. The heuristic alone would split them off one by one, and the stack would need
    // an entry for each. There are 30 boxes of each size, because the sizes alone are limited by the exponents of a float.
    expect_sound(one_group(make(30 * 240, [](uint32_t i) {
        const float size = std::ldexp(1.0f, 120 - static_cast<int>(i / 30));
        return cube(size, 0, 0, size * 0.5f, i);
    })));
}

TEST_P(Builders, TakeHugeAndTinyCoordinates) {
    for (const float size : {1e-44f, 1e-38f, 1e-30f, 1e-10f, 1e10f, 1e19f, 1e30f, 1e37f, 3e38f})
        expect_sound(one_group(scattered(40000, size, 0, 3)));
    // Far from the origin, where neighbouring boxes round to the same coordinates.
    expect_sound(one_group(scattered(40000, 1, 1e7f, 3)));
    expect_sound(one_group(scattered(40000, 1, 1e9f, 3)));
    // Coordinates over the whole range of a float: centroids and extents overflow.
    expect_sound(one_group(make(40000, [](uint32_t i) {
        const float x = FLT_MAX * (static_cast<float>(i % 200) / 100 - 1),
                    y = FLT_MAX * (static_cast<float>(i / 200) / 100 - 1);
        const float lo[3] = {x, y, -FLT_MAX}, hi[3] = {x, y, FLT_MAX};
        return box_prim(lo, hi, i);
    })));
}

TEST_P(Builders, MakeGoodTreesOfNearlyOverflowingScenes) {
    const double plain = built(one_group(scattered(20000, 1, 0, 3))).stats.at("sah_cost");
    for (const float size : {1e-30f, 1e25f, 1e37f})
        EXPECT_NEAR(built(one_group(scattered(20000, size, 0, 3))).stats.at("sah_cost"), plain, 0.01 * plain) << size;
}

TEST_P(Builders, BuildDespiteInvalidBoxes) {
    Input input = one_group(scattered(5000, 1, 0, 5)), meant;
    std::vector<rt_prim>& prims = input.prims;
    prims[10].lo[0] = NAN;
    prims[20].hi[1] = NAN;
    prims[30].lo[0] = prims[30].hi[0] = INFINITY;
    prims[40].lo[2] = -INFINITY;
    std::swap(prims[50].lo, prims[50].hi);
    // NaN bounds become the farthest ones, and bounds in the wrong order are swapped.
    meant = input;
    meant.prims[10].lo[0] = meant.prims[40].lo[2] = -FLT_MAX;
    meant.prims[20].hi[1] = meant.prims[30].lo[0] = meant.prims[30].hi[0] = FLT_MAX;
    std::swap(meant.prims[50].lo, meant.prims[50].hi);
    EXPECT_EQ(GetParam().faults(meant, built(input), {}), "");
}

TEST_P(Builders, BuildTheSameTreeOnAnyNumberOfThreads) {
    Input input;
    input.add_group(bumpy_sphere(150000));
    input.add_group(scattered(70000, 5, 1, 9));
    input.add_group(make(40000, [](uint32_t i) { return cube(1, 2, 3, 4, i); }));
    for (uint32_t g = 0; g < 100; ++g) input.add_group(scattered(40, 1, 0, g));
    number(input);
    const Built once = built(input, {{}, 1, {}});
    ASSERT_EQ(GetParam().faults(input, once, {}), "");
    for (const unsigned threads : {2u, 3u, 8u})
        EXPECT_TRUE(same_tree(plugin(), once, built(input, {{}, threads, {}}))) << threads;
}

TEST_P(Builders, StopWhenCancelled) {
    const Input input = one_group(bumpy_sphere(200000));
    int calls = 0;
    float last = 0;
    const Built whole = built(input, {{}, 2, [&](float fraction) {
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
        const Built stopped = built(input, {{}, 2, [&](float) { return ++n < stop_at; }});
        EXPECT_EQ(stopped.status, RT_CANCELLED) << "at call " << stop_at << " of " << calls;
        EXPECT_LE(n, stop_at + 8);
    }
}

TEST_P(Builders, ShowTheirLevels) {
    Input input = one_group(bumpy_sphere(5000));
    input.add_group({});
    input.add_group({cube(7, 8, 9, 1, 99999)});
    const Built tree = built(input);
    const auto shown = [&](rt_u32 group, rt_u32 level) { return volumes(plugin(), tree, group, level); };
    const auto root = shown(0, 0);
    ASSERT_EQ(root.size(), 1u);
    for (const rt_prim& prim : input.prims) {
        if (prim.ref == 99999) continue;
        for (int a = 0; a < 3; ++a) {
            ASSERT_LE(root[0].lo[a], prim.lo[a]);
            ASSERT_GE(root[0].hi[a], prim.hi[a]);
        }
    }
    const uint32_t width = GetParam().width;
    EXPECT_EQ(shown(0, 1).size(), width);
    EXPECT_EQ(shown(0, 2).size(), width * width);
    EXPECT_TRUE(shown(0, 1000).empty());
    // An empty group has no boxes. The box of a single primitive is root and leaf.
    EXPECT_TRUE(shown(1, 0).empty());
    EXPECT_TRUE(shown(1, RT_LEVEL_BOTTOM).empty());
    ASSERT_EQ(shown(2, 0).size(), 1u);
    if (GetParam().exact_boxes) {
        EXPECT_EQ(shown(2, 0)[0].lo[1], 8.0f);
    }
    EXPECT_EQ(shown(0, RT_LEVEL_BOTTOM).size() + shown(2, RT_LEVEL_BOTTOM).size(), tree.stats.at("leaves"));
    EXPECT_THROW(shown(3, 0), std::runtime_error);
}

// The list keeps all primitives in their order.

TEST(Linear, ListsEveryGroupInOrder) {
    Input input;
    input.add_group(scattered(10, 1, 0, 1));
    input.add_group({});
    input.add_group(scattered(7, 1, 0, 2));
    const Built built = build(load("linear"), input);
    ASSERT_EQ(built.status, RT_OK) << built.why;
    ASSERT_EQ(built.leaves.size(), 17u);
    const rt_u32 firsts[] = {0, 10, 10}, counts[] = {10, 0, 7};
    for (int g = 0; g < 3; ++g) {
        const linear_run& run = built.slot<linear_run>()[built.roots[g]];
        EXPECT_EQ(run.first, firsts[g]);
        EXPECT_EQ(run.count, counts[g]);
        for (rt_u32 i = 0; i < run.count; ++i)
            EXPECT_EQ(built.leaves[run.first + i], input.prims[input.groups[g].first + i].ref);
    }
    EXPECT_EQ(load("linear").accel->levels, nullptr);
}

TEST(Linear, StopsWhenCancelled) {
    Input input;
    input.add_group(scattered(10, 1, 0, 1));
    EXPECT_EQ(build(load("linear"), input, {{}, 1, [](float) { return false; }}).status, RT_CANCELLED);
}
