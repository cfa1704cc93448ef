// bvh8_test.cpp -- the collapsed tree: it is valid for any input, equal on any machine, and as cheap as possible.
#include "bvh8_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <random>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "bvh2_types.h"

using namespace accel_test;

namespace {

const rt_plugin& bvh8() {
    static const rt_plugin& plugin = load("bvh8");
    return plugin;
}

void expect_bvh8(const Input& input, const Options& options = {}) {
    const auto param = [&](const char* key, double otherwise) {
        const auto found = options.params.find(key);
        return found == options.params.end() ? otherwise : found->second;
    };
    EXPECT_EQ(check_bvh8(input, build(bvh8(), input, options), static_cast<uint32_t>(param("max_leaf", 7)),
                         param("traversal_cost", 3), param("intersection_cost", 0.4)),
              "");
}

void number(Input& input) {
    for (size_t i = 0; i < input.prims.size(); ++i) input.prims[i].ref = static_cast<rt_u32>(i);
}

double area(const float* box) {
    const double x = double{box[3]} - box[0], y = double{box[4]} - box[1], z = double{box[5]} - box[2];
    return 2 * (x * y + y * z + z * x);
}

// Returns the area of all inner nodes of the usual greedy collapse of a binary tree: the child with the largest area is opened
// until there are eight children.
double greedy_node_area(const bvh2_node* nodes, rt_u32 root) {
    struct Child {
        const float* box;
        rt_u32 code;
    };
    std::vector<Child> children{{nodes[root].box0, nodes[root].child0}, {nodes[root].box1, nodes[root].child1}};
    while (children.size() < 8) {
        auto largest = children.end();
        for (auto c = children.begin(); c != children.end(); ++c)
            if (!(c->code & BVH2_LEAF) && (largest == children.end() || area(c->box) > area(largest->box))) largest = c;
        if (largest == children.end()) break;
        const bvh2_node& node = nodes[largest->code];
        *largest = {node.box0, node.child0};
        children.push_back({node.box1, node.child1});
    }
    double sum = 0;
    for (const Child& child : children)
        if (!(child.code & BVH2_LEAF)) sum += area(child.box) + greedy_node_area(nodes, child.code);
    return sum;
}

double node_area(const bvh8_node* nodes, rt_u32 index) {
    double sum = 0;
    for (int slot = 0; slot < 8; ++slot) {
        if (nodes[index].child[slot] & BVH8_LEAF) continue;
        float box[6];
        for (int k = 0; k < 6; ++k) box[k] = nodes[index].plane[k][slot];
        sum += area(box) + node_area(nodes, nodes[index].child[slot]);
    }
    return sum;
}

}  // namespace

TEST(Bvh8, CoversEveryPrimitiveOnceWithExactBoxes) {
    for (const uint32_t count : {1u, 2u, 3u, 4u, 5u, 7u, 8u, 9u, 31u, 64u, 65u, 1000u, 16384u, 16385u, 100000u})
        expect_bvh8(one_group(scattered(count, 10, 0, count)));
    expect_bvh8(one_group(bumpy_sphere(200000)));
}

TEST(Bvh8, KeepsToItsParameters) {
    const Input input = one_group(bumpy_sphere(20000));
    for (int max_leaf = 1; max_leaf <= 7; ++max_leaf) {
        expect_bvh8(input, {{{"max_leaf", max_leaf}}, 2, {}});
        expect_bvh8(input, {{{"max_leaf", max_leaf}, {"traversal_cost", 100}}, 2, {}});
    }
    for (const int bins : {2, 3, 5, 16, 31, 32}) expect_bvh8(input, {{{"bins", bins}}, 2, {}});
    expect_bvh8(input, {{{"traversal_cost", 2.5}, {"intersection_cost", 0.5}}, 2, {}});
    // The costs determine how large leaves become.
    const Built cheap_nodes = build(bvh8(), input, {{{"traversal_cost", 0.1}, {"max_leaf", 7}}, 2, {}});
    const Built dear_nodes = build(bvh8(), input, {{{"traversal_cost", 10}, {"max_leaf", 7}}, 2, {}});
    EXPECT_GT(cheap_nodes.stats.at("leaves"), 1.5 * dear_nodes.stats.at("leaves"));
}

TEST(Bvh8, TakesAboutAsMuchMemoryAsEmbree) {
    // The baseline, Embree 3.13 in its usual quality, takes 66 bytes a triangle.
    EXPECT_LT(build(bvh8(), one_group(bumpy_sphere(100000))).stats.at("bytes_per_primitive"), 70);
}

TEST(Bvh8, CollapsesNoWorseThanByOpeningTheLargestChild) {
    for (const std::vector<rt_prim>& prims : {bumpy_sphere(30000), scattered(20000, 1, 0, 6)}) {
        const Input input = one_group(prims);
        // Both collapse the same binary tree, with one primitive per leaf, so that they differ in the inner nodes only.
        const Built binary = build(load("bvh2"), input, {{{"max_leaf", 1}}, 2, {}}),
                    wide = build(bvh8(), input, {{{"max_leaf", 1}}, 2, {}});
        ASSERT_EQ(binary.leaves, wide.leaves);
        const double greedy = greedy_node_area(binary.slot<bvh2_node>(), binary.roots[0]),
                     chosen = node_area(wide.slot<bvh8_node>(), wide.roots[0]);
        EXPECT_LT(chosen, 0.99 * greedy);
        EXPECT_GT(chosen, 0.5 * greedy);  // else the two trees would not be comparable
    }
}

TEST(Bvh8, ChildSlotsFollowTheOctants) {
    std::mt19937 random(1);
    for (int turn = 0; turn < 100; ++turn) {
        std::vector<rt_prim> prims = make(8, [&](uint32_t i) {
            const auto at = [&](uint32_t bit) { return (i & bit ? 4.0f : 0.0f) + static_cast<float>(random() % 1000) / 1000; };
            return cube(at(1), at(2), at(4), 1, i);
        });
        std::shuffle(prims.begin(), prims.end(), random);
        const Built built = build(bvh8(), one_group(prims), {{{"max_leaf", 1}}, 2, {}});
        const bvh8_node& node = built.slot<bvh8_node>()[0];
        for (rt_u32 slot = 0; slot < 8; ++slot) EXPECT_EQ(built.leaves[BVH8_LEAF_FIRST(node.child[slot])], slot);
    }
}

TEST(Bvh8, GroupsOfFewPrimitivesHaveANode) {
    Input input;
    input.add_group({});
    input.add_group({cube(1, 2, 3, 1, 0)});
    input.add_group({cube(1, 2, 3, 1, 1), cube(1, 2, 3, 1, 2)});
    input.add_group({});
    input.add_group(scattered(500, 1, 0, 1));
    number(input);
    expect_bvh8(input);
    expect_bvh8(one_group({}));
    const Built built = build(bvh8(), input);
    for (const rt_u32 child : built.slot<bvh8_node>()[built.roots[3]].child) EXPECT_EQ(child, BVH8_EMPTY);
}

TEST(Bvh8, BuildsManyGroups) {
    Input input;
    for (uint32_t g = 0; g < 10000; ++g) input.add_group(scattered(g % 50, 1, static_cast<float>(g), g));
    input.add_group(scattered(50000, 1, 0, 7));
    number(input);
    expect_bvh8(input);
}

TEST(Bvh8, SplitsPrimitivesThatTheSahCannotSeparate) {
    // All the same box; all the same point; points on a line; boxes around one centre; all but one in the same place.
    expect_bvh8(one_group(make(100000, [](uint32_t i) { return cube(1, 2, 3, 4, i); })));
    expect_bvh8(one_group(make(100000, [](uint32_t i) { return cube(1, 2, 3, 0, i); })));
    expect_bvh8(one_group(make(50000, [](uint32_t i) { return cube(static_cast<float>(i), 0, 0, 0, i); })));
    expect_bvh8(one_group(make(50000, [](uint32_t i) {
        return cube(-static_cast<float>(i), -static_cast<float>(i), -static_cast<float>(i), 2.0f * static_cast<float>(i), i);
    })));
    expect_bvh8(one_group(make(50000, [](uint32_t i) { return cube(i == 77 ? 1e6f : 0.0f, 0, 0, 1, i); })));
    // Each is a fraction of the one before, so that the heuristic alone would split them off one by one.
    expect_bvh8(one_group(make(30 * 240, [](uint32_t i) {
        const float size = std::ldexp(1.0f, 120 - static_cast<int>(i / 30));
        return cube(size, 0, 0, size * 0.5f, i);
    })));
}

TEST(Bvh8, CoincidentBoxesStillFillNodes) {
    const Built built = build(bvh8(), one_group(make(100000, [](uint32_t i) { return cube(1, 2, 3, 4, i); })));
    EXPECT_LE(built.stats.at("depth"), 17);  // halved by count; the minimum would be 5.3
    EXPECT_GT(built.stats.at("children"), 3);
}

#if defined(__SSE2__)
// Embree makes the threads that it has used treat denormal numbers as 0.
TEST(Bvh8, LosesNoPrimitiveWhereDenormalsAreZero) {
    Input input = one_group(make(40, [](uint32_t i) { return cube(float(i % 5) - 2.5f, -0.5f, -0.5f, 1, i); }));
    number(input);
    const unsigned saved = _mm_getcsr();
    _mm_setcsr(saved | 0x8040);
    Options options;
    options.threads = 1;
    expect_bvh8(input, options);
    _mm_setcsr(saved);
}
#endif

TEST(Bvh8, HugeAndTinyScenes) {
    for (const float size : {1e-44f, 1e-38f, 1e-30f, 1e-10f, 1e10f, 1e19f, 1e30f, 1e37f, 3e38f})
        expect_bvh8(one_group(scattered(20000, size, 0, 3)));
    expect_bvh8(one_group(scattered(20000, 1, 1e9f, 3)));
    expect_bvh8(one_group(make(20000, [](uint32_t i) {
        const float x = FLT_MAX * (static_cast<float>(i % 200) / 100 - 1), y = FLT_MAX * (static_cast<float>(i / 200) / 50 - 1);
        const float lo[3] = {x, y, -FLT_MAX}, hi[3] = {x, y, FLT_MAX};
        return box_prim(lo, hi, i);
    })));
    const double plain = build(bvh8(), one_group(scattered(20000, 1, 0, 3))).stats.at("sah_cost");
    for (const float size : {1e-30f, 1e25f, 1e37f})
        EXPECT_NEAR(build(bvh8(), one_group(scattered(20000, size, 0, 3))).stats.at("sah_cost"), plain, 0.01 * plain) << size;
}

TEST(Bvh8, BuildsDespiteInvalidBoxes) {
    std::vector<rt_prim> prims = scattered(5000, 1, 0, 5);
    prims[10].lo[0] = NAN;
    prims[20].hi[1] = NAN;
    prims[30].lo[0] = prims[30].hi[0] = INFINITY;
    std::swap(prims[50].lo, prims[50].hi);
    const Built built = build(bvh8(), one_group(prims));
    ASSERT_EQ(built.status, RT_OK);
    for (size_t n = 0; n < built.slot_counts[0]; ++n)
        for (const auto& row : built.slot<bvh8_node>()[n].plane)
            for (const float plane : row) ASSERT_TRUE(std::isfinite(plane)) << "node " << n;
}

TEST(Bvh8, BuildsTheSameTreeOnAnyNumberOfThreads) {
    Input input;
    input.add_group(bumpy_sphere(150000));
    input.add_group(scattered(70000, 5, 1, 9));
    for (uint32_t g = 0; g < 100; ++g) input.add_group(scattered(40, 1, 0, g));
    number(input);
    const Built once = build(bvh8(), input, {{}, 1, {}});
    ASSERT_EQ(check_bvh8(input, once), "");
    for (const unsigned threads : {2u, 8u}) {
        const Built again = build(bvh8(), input, {{}, threads, {}});
        EXPECT_TRUE(once.leaves == again.leaves && once.roots == again.roots && once.defines == again.defines &&
                    once.stats == again.stats && once.slot_counts == again.slot_counts &&
                    std::memcmp(once.slots[0], again.slots[0], once.slot_counts[0] * sizeof(bvh8_node)) == 0)
            << threads;
    }
}

TEST(Bvh8, StopsWhenCancelled) {
    const Input input = one_group(bumpy_sphere(200000));
    int calls = 0;
    float last = 0;
    const Built whole = build(bvh8(), input, {{}, 2, [&](float fraction) {
                                                  EXPECT_GE(fraction, 0.0f);
                                                  EXPECT_LE(fraction, 1.0f);
                                                  last = fraction;
                                                  ++calls;
                                                  return true;
                                              }});
    EXPECT_EQ(whole.status, RT_OK);
    EXPECT_GT(last, 0.8f);
    for (const int stop_at : {1, 3, calls / 2, calls}) {
        int n = 0;
        const Built stopped = build(bvh8(), input, {{}, 2, [&](float) { return ++n < stop_at; }});
        EXPECT_EQ(stopped.status, RT_CANCELLED) << "at call " << stop_at << " of " << calls;
    }
}

TEST(Bvh8, ShowsItsLevels) {
    Input input = one_group(bumpy_sphere(5000));
    input.add_group({});
    input.add_group({cube(7, 8, 9, 1, 99999)});
    const Built built = build(bvh8(), input);
    const auto root = volumes(bvh8(), built, 0, 0);
    ASSERT_EQ(root.size(), 1u);
    for (const rt_prim& prim : input.prims) {
        if (prim.ref == 99999) continue;
        for (int a = 0; a < 3; ++a) {
            ASSERT_LE(root[0].lo[a], prim.lo[a]);
            ASSERT_GE(root[0].hi[a], prim.hi[a]);
        }
    }
    EXPECT_EQ(volumes(bvh8(), built, 0, 1).size(), 8u);
    EXPECT_EQ(volumes(bvh8(), built, 0, 2).size(), 64u);
    EXPECT_TRUE(volumes(bvh8(), built, 0, 1000).empty());
    EXPECT_TRUE(volumes(bvh8(), built, 1, 0).empty());
    EXPECT_TRUE(volumes(bvh8(), built, 1, RT_LEVEL_BOTTOM).empty());
    ASSERT_EQ(volumes(bvh8(), built, 2, 0).size(), 1u);
    EXPECT_EQ(volumes(bvh8(), built, 2, 0)[0].lo[1], 8.0f);
    EXPECT_EQ(volumes(bvh8(), built, 0, RT_LEVEL_BOTTOM).size() + volumes(bvh8(), built, 2, RT_LEVEL_BOTTOM).size(),
              built.stats.at("leaves"));
    EXPECT_THROW(volumes(bvh8(), built, 3, 0), std::runtime_error);
}
