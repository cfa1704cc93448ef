// spatial_bins_test.cpp -- the bounds of the parts of triangles between planes: they contain the parts, and are tight.
#include "clarity_bvh/build/spatial_bins.hpp"

#include <gtest/gtest.h>

#include <random>

using namespace clarity::bvh;

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
