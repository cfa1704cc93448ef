// linear_test.cpp -- the list keeps all primitives in their order.
#include <gtest/gtest.h>

#include "harness.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "linear_types.h"

using namespace accel_test;

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

// Two parts, one behind the other, are the same list as one build of all groups.
TEST(Linear, BuildsSomeGroupsBehindOthers) {
    Input input;
    input.add_group(scattered(10, 1, 0, 1));
    input.add_group(scattered(7, 1, 0, 2));
    input.add_group(scattered(5, 1, 0, 3));
    const Part meshes{{0, 1, 1}, {0}, 0};
    const Built first = build(load("linear"), input, {}, &meshes);
    ASSERT_EQ(first.status, RT_OK) << first.why;
    EXPECT_EQ(first.leaves.size(), 12u);
    EXPECT_EQ(first.slot_counts[0], 2u);
    EXPECT_EQ(first.roots, (std::vector<rt_u32>{RT_NONE, 0, 1}));
    const Part world{{1, 0, 0}, {first.slot_counts[0]}, first.leaves.size()};
    const Built second = build(load("linear"), input, {}, &world);
    ASSERT_EQ(second.status, RT_OK) << second.why;
    EXPECT_EQ(second.leaves.size(), 10u);
    EXPECT_EQ(second.roots, (std::vector<rt_u32>{2, RT_NONE, RT_NONE}));
    EXPECT_EQ(second.slot<linear_run>()[0].first, 12u);
    EXPECT_EQ(second.slot<linear_run>()[0].count, 10u);
    EXPECT_EQ(second.leaves[3], input.prims[3].ref);
}

TEST(Linear, StopsWhenCancelled) {
    Input input;
    input.add_group(scattered(10, 1, 0, 1));
    EXPECT_EQ(build(load("linear"), input, {{}, 1, [](float) { return false; }}).status, RT_CANCELLED);
}
