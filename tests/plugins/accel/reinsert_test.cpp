// reinsert_test.cpp -- trees after reinsertion: cheaper, no deeper than stacks allow, the same with any number of threads, and
// such that no single move would still make them cheaper.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bvh2_check.hpp"
#include "harness.hpp"

using namespace accel_test;

namespace {

Options reinserting(double passes, double max_leaf = 4, unsigned threads = 2, double builder = 0) {
    return {{{"reinsert", passes}, {"max_leaf", max_leaf}, {"builder", builder}}, threads, {}};
}

// Boxes of many sizes and shapes that overlap each other: the binned heuristic leaves much to gain.
std::vector<rt_prim> crowd(uint32_t count, unsigned seed) {
    std::vector<rt_prim> prims = scattered(count, 10, 0, seed);
    for (uint32_t i = 0; i < count; ++i)
        for (int a = 0; a < 3; ++a)
            prims[i].hi[a] += static_cast<float>((i * 2654435761u >> 8 * a & 255u) % (i % 9 == 0 ? 200 : 12)) * 0.02f;
    return prims;
}

Input crowds() {
    Input input;
    for (const uint32_t count : {6000u, 0u, 1u, 2u, 3u, 9u, 700u}) input.add_group(crowd(count, count));
    input.add_group(bumpy_sphere(2000));
    number(input);
    return input;
}

// ---- by trial: what the best single move of a tree would gain

struct TrialBox {
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    void add(const TrialBox& b) {
        for (int a = 0; a < 3; ++a) lo[a] = std::min(lo[a], b.lo[a]), hi[a] = std::max(hi[a], b.hi[a]);
    }
    double area() const {
        const double x = hi[0] - lo[0], y = hi[1] - lo[1], z = hi[2] - lo[2];
        return 2 * (x * y + y * z + z * x);
    }
};

// A subtree, by its index in Trial::items.
struct TrialItem {
    int parent = -1, child[2] = {-1, -1};
    TrialBox box;  // of a leaf
};

struct Trial {
    std::vector<TrialItem> items;

    explicit Trial(const Built& built) { add(built, built.roots[0], -1); }
    int add(const Built& built, rt_u32 index, int parent) {
        const bvh2_node& node = built.slot<bvh2_node>()[index];
        const int at = append(parent);
        for (int c = 0; c < 2; ++c) {
            const rt_u32 code = c == 0 ? node.child0 : node.child1;
            int child;
            if (code & BVH2_LEAF) {
                child = append(at);
                std::copy_n(c == 0 ? node.box0 : node.box1, 3, items[child].box.lo);
                std::copy_n((c == 0 ? node.box0 : node.box1) + 3, 3, items[child].box.hi);
            } else {
                child = add(built, code, at);
            }
            items[at].child[c] = child;
        }
        return at;
    }
    int append(int parent) {
        items.emplace_back();
        items.back().parent = parent;
        return static_cast<int>(items.size()) - 1;
    }
    // The surfaces of all inner nodes below, in sum.
    double surface(int at, TrialBox& box) const {
        const TrialItem& item = items[at];
        if (item.child[0] < 0) return box.add(item.box), 0;
        TrialBox own;
        const double below = surface(item.child[0], own) + surface(item.child[1], own);
        box.add(own);
        return below + own.area();
    }
    double surface() const {
        TrialBox box;
        return surface(0, box);
    }
    void replace(int parent, int from, int to) {
        for (int& child : items[parent].child)
            if (child == from) child = to;
        items[to].parent = parent;
    }
    bool is_below(int at, int top) const {
        for (; at >= 0; at = items[at].parent)
            if (at == top) return true;
        return false;
    }
    // Tries every move of every subtree. The root and its children stay.
    double best_gain() const {
        const double before = surface();
        double best = 0;
        for (int from = 1; from < static_cast<int>(items.size()); ++from)
            for (int to = 1; to < static_cast<int>(items.size()); ++to) {
                const int parent = items[from].parent;
                if (parent == 0 || to == parent || items[to].parent == parent || is_below(to, from)) continue;
                Trial moved = *this;
                const int sibling = items[parent].child[items[parent].child[0] == from];
                moved.replace(items[parent].parent, parent, sibling);
                moved.replace(moved.items[to].parent, to, parent);
                moved.items[parent].child[0] = from;
                moved.items[parent].child[1] = to;
                moved.items[to].parent = parent;
                best = std::max(best, before - moved.surface());
            }
        return best / before;
    }
};

}  // namespace

TEST(Reinsert, NeverMakesATreeDearerAndKeepsEveryPrimitive) {
    for (const Input& input : {one_group(bumpy_sphere(6000)), crowds()})
        for (const double builder : {0.0, 1.0}) {
            double last = build(load("bvh2"), input, reinserting(0, 1, 2, builder)).stats.at("sah_cost");
            const double first = last;
            for (const double passes : {1.0, 2.0, 3.0, 40.0}) {
                const Options options = reinserting(passes, 1, 2, builder);
                const Built built = build(load("bvh2"), input, options);
                EXPECT_EQ(check_bvh2(input, built, 1), "");
                EXPECT_LE(built.stats.at("sah_cost"), last * (1 + 1e-9)) << passes;
                last = built.stats.at("sah_cost");
            }
            EXPECT_LT(last, (builder == 1 ? 0.95 : 0.999) * first);
        }
}

TEST(Reinsert, PaysWhereBoxesOverlap) {
    for (const char* id : {"bvh2", "bvh4", "bvh8", "cwbvh"}) {
        const Input input = one_group(crowd(6000, 5));
        EXPECT_LT(build(load(id), input, reinserting(10)).stats.at("sah_cost"),
                  0.97 * build(load(id), input, reinserting(0)).stats.at("sah_cost"))
            << id;
    }
}

TEST(Reinsert, DoesNotDependOnTheNumberOfThreads) {
    const Input input = crowds();
    for (const char* id : {"bvh2", "bvh4", "bvh8", "cwbvh"}) {
        const Built one = build(load(id), input, reinserting(4, 4, 1));
        for (const unsigned threads : {2u, 7u})
            EXPECT_TRUE(same_tree(load(id), one, build(load(id), input, reinserting(4, 4, threads)))) << id;
    }
}

TEST(Reinsert, DoesNotDependOnTheInstructionSet) {
    for (const char* library : {BVH2_PORTABLE_LIBRARY, BVH2_NO_AVX2_LIBRARY})
        for (const Input& input : {crowds(), one_group(scattered(1000, 1e30f, 0, 2)), one_group(scattered(1000, 1e-38f, 0, 2))})
            EXPECT_TRUE(same_tree(load("bvh2"), build(load("bvh2"), input, reinserting(4)),
                                  build(load("bvh2", library), input, reinserting(4))))
                << library;
}

TEST(Reinsert, LeavesNoMoveThatPays) {
    for (const unsigned seed : {1u, 2u, 3u}) {
        const Input input = one_group(crowd(60, seed));
        // Along a curve: a tree that leaves more to gain.
        const double before = Trial(build(load("bvh2"), input, reinserting(0, 1, 2, 1))).best_gain(),
                     after = Trial(build(load("bvh2"), input, reinserting(100, 1, 2, 1))).best_gain();
        EXPECT_GT(before, 0.01) << seed;
        EXPECT_LT(after, 0.001) << seed;
    }
}

TEST(Reinsert, KeepsWaysShortEnoughForStacks) {
    // Boxes inside each other. Their best tree is a chain.
    const Input nested = one_group(make(3000, [](uint32_t i) { return cube(0, 0, 0, 1 + static_cast<float>(i), i); }));
    const Input shrinking = one_group(make(30 * 240, [](uint32_t i) {
        const float size = std::ldexp(1.0f, 120 - static_cast<int>(i / 30));
        return cube(size, 0, 0, size * 0.5f, i);
    }));
    for (const Input& input : {nested, shrinking, one_group(crowd(6000, 5))}) {
        const Built before = build(load("bvh2"), input, reinserting(0, 1)),
                    after = build(load("bvh2"), input, reinserting(40, 1));
        EXPECT_EQ(check_bvh2(input, after, 1), "");
        EXPECT_LE(after.stats.at("depth"), std::max(before.stats.at("depth"), std::min(before.stats.at("depth") + 4, 64.0)));
        EXPECT_LE(after.defines.at("BVH2_STACK"), 72u);
    }
}

TEST(Reinsert, StopsWhenCancelled) {
    Options options = reinserting(4);
    std::atomic<bool> reached{false};
    options.progress = [&](float share) { return !(reached = reached || share > 0.2f); };
    EXPECT_EQ(build(load("bvh2"), one_group(crowd(6000, 5)), options).status, RT_CANCELLED);
    EXPECT_TRUE(reached);
}
