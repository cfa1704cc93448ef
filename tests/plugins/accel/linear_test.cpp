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

TEST(Linear, StopsWhenCancelled) {
    Input input;
    input.add_group(scattered(10, 1, 0, 1));
    EXPECT_EQ(build(load("linear"), input, {{}, 1, [](float) { return false; }}).status, RT_CANCELLED);
}
