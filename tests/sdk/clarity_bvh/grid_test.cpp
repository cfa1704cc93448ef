// grid_test.cpp -- quantised coordinates: planes are never inside of what they bound, and cells are as small as they can be.
#include "clarity_bvh/wide/grid.hpp"

#include <gtest/gtest.h>

#include <cfloat>
#include <random>

using namespace clarity::bvh;

namespace {

constexpr GridRule kRule{32768.0f, 1.0f / 128.0f, -100, 112};

TEST(Grid, FourPlanesAtOnceAreTheSame) {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> any(-7, 100);
    const Grid grid = Grid::around(kRule, -7, 100);
    for (int i = 0; i < 1000; ++i) {
        const float planes[4] = {any(random), any(random), any(random), any(random)};
        int low[4], high[4];
        grid.lower_four(load_any(planes), low);
        grid.upper_four(load_any(planes), high);
        for (int k = 0; k < 4; ++k) {
            EXPECT_EQ(low[k], grid.lower(planes[k])) << planes[k];
            EXPECT_EQ(high[k], grid.upper(planes[k])) << planes[k];
        }
    }
}

}  // namespace

TEST(Grid, PlanesBoundCoordinates) {
    std::mt19937 random(3);
    for (int turn = 0; turn < 20000; ++turn) {
        const double size = std::pow(10.0, static_cast<int>(random() % 60) - 30), at = turn % 3 == 0 ? 0 : 1000 * size;
        const auto number = [&] { return static_cast<float>(at + size * (random() % 20001) / 10000); };
        const float a = number(), b = number(), lo = std::min(a, b), hi = std::max(a, b), x = lo + (hi - lo) * 0.37f;
        const Grid grid = Grid::around(kRule, lo, hi);
        ASSERT_FALSE(grid.unbounded());
        const double margin = std::ldexp(double{kRule.margin}, grid.exponent());
        for (const float plane : {lo, x, hi}) {
            const int low = grid.lower(plane), high = grid.upper(plane);
            ASSERT_GE(low, 0);
            ASSERT_LE(high, Grid::kPlanes);
            EXPECT_LE(grid.plane(static_cast<uint32_t>(low)), plane - 0.999 * margin);
            EXPECT_GE(grid.plane(static_cast<uint32_t>(high)), plane + 0.999 * margin);
        }
    }
}

TEST(Grid, CellsAreAsSmallAsTheyCanBe) {
    const Grid grid = Grid::around(kRule, 0, 200);
    EXPECT_EQ(grid.exponent(), 0);
    EXPECT_EQ(Grid::around(kRule, 0, 0).exponent(), -100);
}

TEST(Grid, HugeAxesAreUnbounded) {
    EXPECT_TRUE(Grid::around(kRule, -FLT_MAX, FLT_MAX).unbounded());
}
