// share_roots_test.cpp -- compares the inner step of the collapse with a search through all divisions, for each instruction
// set.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "clarity_bvh/kernels/kernels.hpp"

using namespace clarity::bvh;

TEST(ShareRoots, MinimizeTheCostAndThenTheLeftShare) {
    std::mt19937 random(5);
    for (int turn = 0; turn < 5000; ++turn) {
        float left[kRoots], right[2 * kRoots];
        for (uint32_t i = 0; i < kRoots; ++i) {
            left[i] = static_cast<float>(random() % 50);  // few values: ties are common
            right[i] = INFINITY;
            right[kRoots + i] = static_cast<float>(random() % 50);
        }
        for (const Kernels* k : {&kernels(), &generic::kernels}) {
            SharedRoots shared;
            k->share_roots(left, right, shared);
            EXPECT_EQ(shared.cost[0], INFINITY);
            for (uint32_t roots = 2; roots <= kRoots; ++roots) {
                float best = INFINITY;
                uint32_t fewest = 0;
                for (uint32_t l = 1; l < roots; ++l)
                    if (left[l - 1] + right[kRoots + roots - l - 1] < best) {
                        best = left[l - 1] + right[kRoots + roots - l - 1];
                        fewest = l;
                    }
                ASSERT_EQ(shared.cost[roots - 1], best) << roots;
                ASSERT_EQ(shared.left[roots - 1], static_cast<float>(fewest)) << roots;
            }
        }
    }
}
