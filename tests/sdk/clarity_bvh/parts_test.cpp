// parts_test.cpp -- parts of the library. Quantised coordinates: planes are never inside of what they bound, and cells are as
// small as they can be.
#include "clarity_bvh/wide/grid.hpp"

#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <random>

#include "clarity_bvh/build/spatial_bins.hpp"
#include "clarity_bvh/kernels/kernels.hpp"

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

// Compares the inner step of the collapse with a search through all divisions, for each instruction
// set.

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

// Compares the assignment of children to slots with a search through all pairs, for each instruction
// set.

namespace {

// Returns the number with the tag of a pair in its lowest bits.
float tagged(float value, uint32_t tag) {
    uint32_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    bits = (bits & ~(kTags - 1)) | tag;
    std::memcpy(&value, &bits, sizeof bits);
    return value;
}

}  // namespace

TEST(AssignPlaces, AssignsTheBestPairFirst) {
    std::mt19937 random(7);
    for (int turn = 0; turn < 3000; ++turn) {
        const uint32_t count = 1 + turn % kPlaces;
        Suits suits[kPlaces];
        for (uint32_t i = 0; i < count; ++i)
            for (uint32_t p = 0; p < kPlaces; ++p)
                suits[i].place[p] = tagged(static_cast<float>(static_cast<int>(random() % 20) - 10) + 0.5f, kPlaces * i + p);
        uint32_t expected[kPlaces] = {};
        bool gone[kPlaces] = {}, taken[kPlaces] = {};
        for (uint32_t left = count; left > 0; --left) {
            uint32_t thing = kPlaces, place = 0;
            for (uint32_t i = 0; i < count; ++i)
                for (uint32_t p = 0; p < kPlaces; ++p)
                    if (!gone[i] && !taken[p] && (thing == kPlaces || suits[i].place[p] > suits[thing].place[place])) {
                        thing = i;
                        place = p;
                    }
            expected[thing] = place;
            gone[thing] = taken[place] = true;
        }
        for (const Kernels* k : {&kernels(), &generic::kernels}) {
            Suits own[kPlaces];
            std::copy_n(suits, count, own);
            uint32_t place_of[kPlaces] = {};
            k->assign_places(own, count, place_of);
            for (uint32_t i = 0; i < count; ++i) ASSERT_EQ(place_of[i], expected[i]) << "thing " << i << " of " << count;
        }
    }
}

// The bounds of the parts of triangles between planes: they contain the parts, and are tight.

namespace {

rt_packed_prim random_triangle(std::mt19937& random, float center, float size) {
    rt_packed_prim leaf{};
    for (float* corner : {leaf.a, leaf.b, leaf.c})
        for (int k = 0; k < 3; ++k) corner[k] = center + size * (static_cast<float>(random() % 10001) / 5000 - 1);
    return leaf;
}

Bounds bounds_of(const rt_packed_prim& t) {
    Bounds box;
    for (const float* corner : {t.a, t.b, t.c})
        for (int k = 0; k < 3; ++k) {
            box.lo[k] = std::min(box.lo[k], corner[k]);
            box.neg_hi[k] = std::min(box.neg_hi[k], -corner[k]);
        }
    return box;
}

}  // namespace

TEST(SpatialBins, BoundsOfPartsHoldThem) {
    std::mt19937 random(11);
    for (int turn = 0; turn < 2000; ++turn) {
        const float center = turn % 3 == 0 ? 1000.0f : 0.0f, size = turn % 2 ? 1.0f : 1e-3f;
        const rt_packed_prim t = random_triangle(random, center, size);
        const Bounds whole = bounds_of(t);
        const int axis = turn % 3;
        const float plane = 0.5f * whole.lo[axis] + 0.5f * whole.hi(axis);
        const Bounds below = clip(t, whole, axis, -FLT_MAX, plane), above = clip(t, whole, axis, plane, FLT_MAX);
        EXPECT_LE(below.hi(axis), plane);
        EXPECT_GE(above.lo[axis], plane);
        for (int sample = 0; sample < 50; ++sample) {
            double u = static_cast<double>(random() % 1001) / 1000, v = static_cast<double>(random() % 1001) / 1000;
            if (u + v > 1) {
                u = 1 - u;
                v = 1 - v;
            }
            double p[3];
            for (int k = 0; k < 3; ++k) p[k] = t.a[k] + u * (double{t.b[k]} - t.a[k]) + v * (double{t.c[k]} - t.a[k]);
            const Bounds& part = p[axis] <= plane ? below : above;
            for (int k = 0; k < 3; ++k) {
                EXPECT_GE(p[k], part.lo[k] - 1e-12 * (1 + std::fabs(p[k]))) << turn;
                EXPECT_LE(p[k], part.hi(k) + 1e-12 * (1 + std::fabs(p[k]))) << turn;
            }
        }
    }
}

TEST(SpatialBins, PartsAreTight) {
    rt_packed_prim t{};
    t.b[0] = t.b[1] = 4;  // a = 0, b = (4 4 0), c = (4 4 1)
    t.c[0] = t.c[1] = 4;
    t.c[2] = 1;
    const Bounds part = clip(t, bounds_of(t), 0, 1, 2);
    EXPECT_EQ(part.lo[0], 1.0f);
    EXPECT_EQ(part.hi(0), 2.0f);
    EXPECT_NEAR(part.lo[1], 1, 1e-6);
    EXPECT_NEAR(part.hi(1), 2, 1e-6);
    EXPECT_NEAR(part.hi(2), 0.5, 1e-6);
    EXPECT_EQ(part.lo[2], 0.0f);
}

TEST(SpatialBins, CountsWhatEntersAndLeaves) {
    // One triangle crosses all slices, one lies within the third.
    Record records[2];
    rt_packed_prim triangles[2] = {};
    triangles[0].b[0] = kSpatialBins;
    triangles[0].c[1] = 1;
    triangles[1].a[0] = 2.25f;
    triangles[1].b[0] = triangles[1].c[0] = 2.75f;
    triangles[1].c[1] = 1;
    for (rt_u32 i = 0; i < 2; ++i) {
        const Bounds box = bounds_of(triangles[i]);
        for (int k = 0; k < 4; ++k) {
            records[i].lo[k] = k < 3 ? box.lo[k] : 0;
            records[i].neg_hi[k] = k < 3 ? box.neg_hi[k] : 0;
        }
        records[i].set_ref(i);
    }
    Bounds space = bounds_of(triangles[0]);
    const Planes planes(space);
    const rt_geometry geometry{sizeof(rt_geometry), triangles, 2};
    SpatialBins bins;
    bins.add(records, records + 2, planes, geometry);
    EXPECT_EQ(bins.enter[0][0], 1u);
    EXPECT_EQ(bins.leave[kSpatialBins - 1][0], 1u);
    EXPECT_EQ(bins.enter[2][0], 1u);
    EXPECT_EQ(bins.leave[2][0], 1u);
    EXPECT_EQ(bins.box[5][0].lo[0], 5.0f);
    EXPECT_EQ(bins.box[5][0].hi(0), 6.0f);
    const SpatialSplit split = find_spatial_split(bins, AreaScale(space));
    EXPECT_LT(split.cost, INFINITY);
    EXPECT_EQ(split.left_count + split.right_count, 3u);  // every plane cuts the first triangle only
}
