// spatial_test.cpp -- trees with spatial splits: no part of any triangle is lost, the memory limit holds, and rays get cheaper.
#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <random>

#include "harness.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh2_types.h"
#include "bvh8_types.h"

using namespace accel_test;

namespace {

constexpr double kSah = 0, kSpatial = 2;  // values of the parameter `builder`

Options with(double builder, double duplicates = 0.5, unsigned threads = 2) {
    return {{{"builder", builder}, {"duplicates", duplicates}}, threads, {}};
}

rt_packed_prim triangle(const float a[3], const float b[3], const float c[3], rt_u32 ref) {
    rt_packed_prim leaf{};
    std::memcpy(leaf.a, a, sizeof leaf.a);
    std::memcpy(leaf.b, b, sizeof leaf.b);
    std::memcpy(leaf.c, c, sizeof leaf.c);
    leaf.ref = ref;
    return leaf;
}

void add(Input& input, std::vector<rt_prim>& group, const rt_packed_prim& t) {
    input.triangles.push_back(t);
    float lo[3], hi[3];
    for (int k = 0; k < 3; ++k) {
        lo[k] = std::min({t.a[k], t.b[k], t.c[k]});
        hi[k] = std::max({t.a[k], t.b[k], t.c[k]});
    }
    group.push_back(box_prim(lo, hi, t.ref));
}

// Returns long thin triangles in all directions within `size`. Their boxes are mostly empty.
Input sticks(uint32_t count, float size) {
    std::mt19937 random(7);
    const auto number = [&] { return size * (static_cast<float>(random() % 20001) / 10000 - 1); };
    Input input;
    std::vector<rt_prim> group;
    for (rt_u32 i = 0; i < count; ++i) {
        const float a[3] = {number(), number(), number()}, b[3] = {number(), number(), number()};
        const float c[3] = {b[0] + 0.01f * size, b[1], b[2] + 0.01f * size};
        add(input, group, triangle(a, b, c, i));
    }
    input.add_group(group);
    return input;
}

struct Leaf {
    float box[6];
    rt_u32 first, count;
};
std::vector<Leaf> leaves_of(const Built& built, bool wide) {
    std::vector<Leaf> leaves;
    const auto see = [&](const float* box, rt_u32 child) {
        if (!(child & BVH2_LEAF) || BVH2_LEAF_COUNT(child) == 0) return;
        Leaf leaf;
        std::memcpy(leaf.box, box, sizeof leaf.box);
        leaf.first = BVH2_LEAF_FIRST(child);  // bvh8 has the same leaf codes
        leaf.count = BVH2_LEAF_COUNT(child);
        leaves.push_back(leaf);
    };
    for (size_t n = 0; n < built.slot_counts[0]; ++n) {
        if (wide) {
            const bvh8_node& node = built.slot<bvh8_node>()[n];
            for (int slot = 0; slot < BVH8_WIDTH; ++slot) {
                float box[6];
                for (int k = 0; k < 6; ++k) box[k] = node.plane[k][slot];
                see(box, node.child[slot]);
            }
        } else {
            const bvh2_node& node = built.slot<bvh2_node>()[n];
            see(node.box0, node.child0);
            see(node.box1, node.child1);
        }
    }
    return leaves;
}

// Checks that every position in leaf order is in exactly one leaf, and that every sampled point of a triangle is in the box of
// a leaf that holds the triangle.
void expect_spatial(const Input& input, const Built& built, bool wide) {
    ASSERT_EQ(built.status, RT_OK) << built.why;
    std::vector<int> seen(built.leaves.size());
    std::vector<std::vector<Leaf>> of_triangle(input.triangles.size());
    for (const Leaf& leaf : leaves_of(built, wide))
        for (rt_u32 i = leaf.first; i < leaf.first + leaf.count; ++i) {
            ASSERT_LT(i, seen.size());
            ++seen[i];
            ASSERT_LT(built.leaves[i], input.triangles.size());
            of_triangle[built.leaves[i]].push_back(leaf);
        }
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(seen.size()));
    std::mt19937 random(3);
    for (size_t t = 0; t < input.triangles.size(); ++t) {
        const rt_packed_prim& tri = input.triangles[t];
        float size = 0;
        for (int k = 0; k < 3; ++k) size = std::max({size, std::fabs(tri.a[k]), std::fabs(tri.b[k]), std::fabs(tri.c[k])});
        for (int sample = 0; sample < 40; ++sample) {
            // Samples: first the corners, then points on edges, then points anywhere.
            double w[3] = {double(sample == 0), double(sample == 1), double(sample == 2)};
            if (sample > 2) {
                for (double& x : w) x = static_cast<double>(random() % 1001) / 1000;
                if (sample < 20) w[sample % 3] = 0;
                const double sum = w[0] + w[1] + w[2];
                if (!(sum > 0)) continue;
                for (double& x : w) x /= sum;
            }
            const double room = sample < 3 ? 0 : 1e-9 * size;  // rounding error of double arithmetic
            const bool held = std::any_of(of_triangle[t].begin(), of_triangle[t].end(), [&](const Leaf& leaf) {
                for (int k = 0; k < 3; ++k) {
                    const double x = w[0] * tri.a[k] + w[1] * tri.b[k] + w[2] * tri.c[k];
                    if (x < leaf.box[k] - room || x > leaf.box[3 + k] + room) return false;
                }
                return true;
            });
            ASSERT_TRUE(held) << "triangle " << t << " sample " << sample << " of " << of_triangle[t].size() << " leaves";
        }
    }
}

}  // namespace

TEST(Spatial, LosesNothingOfAnyTriangle) {
    for (const char* id : {"bvh2", "bvh8"})
        for (const float size : {1e-20f, 1.0f, 1e20f})
            for (const double max_leaf : {1, 4}) {
                Options options = with(kSpatial, 1);
                options.params["max_leaf"] = max_leaf;
                const Input input = sticks(3000, size);
                expect_spatial(input, build(load(id), input, options), id[3] == '8');
            }
}

TEST(Spatial, LimitsTheShareOfDuplicates) {
    const Input input = sticks(20000, 1);
    double last = 0;
    for (const double share : {0.0, 0.05, 0.3, 2.0}) {
        const Built built = build(load("bvh8"), input, with(kSpatial, share));
        const double references = built.stats.at("references");
        EXPECT_EQ(references, static_cast<double>(built.leaves.size()));
        EXPECT_LE(references, 20000 * (1 + share));
        EXPECT_GE(references, last);
        last = references;
    }
    EXPECT_GT(last, 1.3 * 20000);  // the allowed duplicates are really used
}

TEST(Spatial, LowersTheCostOfLongTriangles) {
    const Input input = sticks(4000, 1);
    for (const char* id : {"bvh2", "bvh8"}) {
        const double plain = build(load(id), input, with(kSah)).stats.at("sah_cost"),
                     cut = build(load(id), input, with(kSpatial, 4)).stats.at("sah_cost");
        EXPECT_LT(cut, 0.9 * plain) << id;
    }
}

TEST(Spatial, DoesNotSplitOtherPrimitives) {
    // Spheres and instances among long triangles: each is in exactly one leaf.
    Input input = sticks(2000, 1);
    std::vector<rt_prim> group = input.prims;
    for (rt_u32 i = 0; i < 500; ++i) {
        const float x = static_cast<float>(i) / 250 - 1, lo[3] = {x - 0.2f, -0.5f, -0.5f}, hi[3] = {x + 0.2f, 0.5f, 0.5f};
        group.push_back(box_prim(lo, hi, (i % 2 ? RT_REF_SPHERE : RT_REF_INSTANCE) | i));
    }
    Input mixed;
    mixed.triangles = input.triangles;
    mixed.add_group(group);
    const Built built = build(load("bvh2"), mixed, with(kSpatial, 1));
    ASSERT_EQ(built.status, RT_OK) << built.why;
    EXPECT_GT(built.leaves.size(), mixed.prims.size() + 100);
    for (rt_u32 i = 0; i < 500; ++i)
        EXPECT_EQ(std::count(built.leaves.begin(), built.leaves.end(), (i % 2 ? RT_REF_SPHERE : RT_REF_INSTANCE) | i), 1);
}

TEST(Spatial, BuildsForFewFlatAndEqualTriangles) {
    for (const uint32_t count : {1u, 2u, 3u, 5u, 9u, 40u}) {
        const Input input = sticks(count, 1);
        for (const char* id : {"bvh2", "bvh8"}) expect_spatial(input, build(load(id), input, with(kSpatial)), id[3] == '8');
    }
    Input flat, same;
    std::vector<rt_prim> flat_group, same_group;
    for (rt_u32 i = 0; i < 5000; ++i) {
        const float x = static_cast<float>(i % 70), y = static_cast<float>(i / 70);
        const float a[3] = {x, y, 0}, b[3] = {x + 9, y, 0}, c[3] = {x, y + 9, 0};
        add(flat, flat_group, triangle(a, b, c, i));
        const float p[3] = {1, 2, 3}, q[3] = {9, 2, 5}, r[3] = {4, 7, 1};
        add(same, same_group, triangle(p, q, r, i));
    }
    flat.add_group(flat_group);
    same.add_group(same_group);
    for (const Input& input : {flat, same})
        for (const char* id : {"bvh2", "bvh8"}) expect_spatial(input, build(load(id), input, with(kSpatial)), id[3] == '8');
    EXPECT_EQ(build(load("bvh2"), Input{{}, {{0, 0}}, {}}, with(kSpatial)).status, RT_OK);
}

TEST(Spatial, GroupsStaySeparate) {
    Input input = sticks(3000, 1);
    std::vector<rt_prim> first(input.prims.begin(), input.prims.begin() + 1000),
        rest(input.prims.begin() + 1000, input.prims.end());
    Input parted;
    parted.triangles = input.triangles;
    parted.add_group({});
    parted.add_group(first);
    parted.add_group(rest);
    for (const char* id : {"bvh2", "bvh8"}) expect_spatial(parted, build(load(id), parted, with(kSpatial)), id[3] == '8');
}

TEST(Spatial, BuildsTheSameTreeOnAnyMachine) {
    const Input input = sticks(20000, 1);
    const Built once = build(load("bvh2"), input, with(kSpatial, 0.5, 1));
    const auto expect_same = [&](const Built& other, const char* which) {
        EXPECT_TRUE(once.leaves == other.leaves && once.slot_counts == other.slot_counts && once.stats == other.stats &&
                    std::memcmp(once.slots[0], other.slots[0], once.slot_counts[0] * sizeof(bvh2_node)) == 0)
            << which;
    };
    expect_same(build(load("bvh2"), input, with(kSpatial, 0.5, 2)), "2 threads");
    expect_same(build(load("bvh2"), input, with(kSpatial, 0.5, 8)), "8 threads");
    expect_same(build(load("bvh2", BVH2_PORTABLE_LIBRARY), input, with(kSpatial)), "no vectors");
    expect_same(build(load("bvh2", BVH2_NO_AVX2_LIBRARY), input, with(kSpatial)), "no AVX2");
}
