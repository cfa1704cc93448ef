// treelets_test.cpp -- optimised trees are cheaper, and hold what they held.
#include "clarity_bvh/build/treelets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "clarity_bvh/build/builder.hpp"
#include "services.hpp"

using namespace clarity::bvh;

namespace {

struct Boxes {
    std::vector<rt_prim> prims;
    std::vector<rt_group> groups;

    void add(uint32_t count, float size) {
        std::mt19937 random(count);
        const auto number = [&] { return static_cast<float>(random() % 100001) / 100000; };
        groups.push_back({static_cast<rt_u32>(prims.size()), count});
        for (uint32_t i = 0; i < count; ++i) {
            rt_prim prim{};
            for (int a = 0; a < 3; ++a) {
                prim.lo[a] = size * number();
                prim.hi[a] = prim.lo[a] + size * 0.05f * number() * number();
            }
            prim.ref = RT_REF_SPHERE | static_cast<rt_u32>(prims.size());
            prims.push_back(prim);
        }
    }
    rt_build_input input() const {
        static const rt_geometry geometry{sizeof(rt_geometry), nullptr, 0};
        static const double params[1] = {};
        rt_build_input input{};
        input.struct_bytes = sizeof input;
        input.group_count = static_cast<rt_u32>(groups.size());
        input.prims = prims.data();
        input.groups = groups.data();
        input.geometry = &geometry;
        input.params = params;
        return input;
    }
};

struct Built {
    std::vector<uint32_t> refs;
    RefMemory memory() {
        return [this](uint64_t count) {
            refs.resize(count);
            return refs.data();
        };
    }
};

double cost(const Topology& topology, const Boxes& boxes) {
    return measure(topology, boxes.groups.data(), 1, 1).sah_cost;
}

// The leaves as sorted lists of sorted refs.
std::vector<std::vector<uint32_t>> leaves_of(const Topology& topology, const std::vector<uint32_t>& refs) {
    std::vector<std::vector<uint32_t>> result;
    const auto look = [&](uint32_t code) {
        if (!is_leaf(code)) return;
        result.emplace_back(refs.begin() + leaf_first(code), refs.begin() + leaf_first(code) + leaf_count(code));
        std::sort(result.back().begin(), result.back().end());
    };
    const auto look_at = [&](uint32_t node) {
        look(topology.nodes.data()[node].child0);
        look(topology.nodes.data()[node].child1);
    };
    for (const Part& part : topology.parts)
        for (uint32_t i = 0; i < part.node_count; ++i) look_at(part.first_node + i);
    for (const Top& top : topology.tops) look_at(top.node);
    for (const Root& root : topology.roots)
        if (root.code != RT_NONE) look(root.code);
    std::sort(result.begin(), result.end());
    return result;
}

}  // namespace

TEST(Treelets, MakeTreesCheaperAndKeepTheirLeaves) {
    Boxes boxes;
    for (const uint32_t count : {20000u, 0u, 1u, 2u, 9u, 300u}) boxes.add(count, static_cast<float>(1 + count));
    for (const Method method : {Method::morton, Method::sah}) {
        const bvh_test::Services services;
        Built before, after;
        const Topology from = build_topology(services.host(), boxes.input(), {4, 32, 1, 1, method}, before.memory());
        const Topology to = optimize_treelets(services.host(), from, before.refs.data(), {}, after.memory());
        const double gain = cost(from, boxes) / cost(to, boxes);
        EXPECT_GT(gain, method == Method::morton ? 1.02 : 1.008);  // most of the cost is that of the leaves, which stay
        EXPECT_EQ(leaves_of(from, before.refs), leaves_of(to, after.refs));
        EXPECT_LE(to.depth, std::max(from.depth, kMaxDepth));
        ASSERT_EQ(from.roots.size(), to.roots.size());
        for (size_t g = 0; g < to.roots.size(); ++g) EXPECT_EQ(std::memcmp(from.roots[g].box.lo, to.roots[g].box.lo, 12), 0);
    }
}

// Four boxes of two clusters, paired across the clusters: the cheapest tree is known.
TEST(Treelets, FindTheCheapestTree) {
    Boxes boxes;
    boxes.groups.push_back({0, 4});
    for (const float x : {0.0f, 100.0f, 1.0f, 101.0f}) {
        rt_prim prim{};
        prim.lo[0] = x;
        prim.hi[0] = x + 1;
        prim.hi[1] = prim.hi[2] = 1;
        prim.ref = RT_REF_SPHERE | static_cast<rt_u32>(boxes.prims.size());
        boxes.prims.push_back(prim);
    }
    // ((0, 1), (2, 3)), where 0 and 2 are neighbours, and so are 1 and 3.
    Topology bad{Scratch<Node>(3), {}, {}, std::vector<Root>(1)};
    std::vector<Bounds> box(4);
    for (int i = 0; i < 4; ++i) box[i].add(boxes.prims[i].lo, boxes.prims[i].hi);
    Bounds pair[2], all;
    for (int p = 0; p < 2; ++p) {
        pair[p].add(box[2 * p]);
        pair[p].add(box[2 * p + 1]);
        all.add(pair[p]);
        set_child(bad.nodes.data()[0], p, pair[p], static_cast<uint32_t>(1 + p));
        for (int c = 0; c < 2; ++c)
            set_child(bad.nodes.data()[1 + p], c, box[2 * p + c], make_leaf(static_cast<uint32_t>(2 * p + c), 1));
    }
    bad.parts.push_back({0, unit_scale(all), 0, 3, 2});
    bad.roots[0] = {all, 0};
    bad.ref_count = 4;
    bad.depth = 2;
    const bvh_test::Services services;
    const std::vector<uint32_t> refs{0, 1, 2, 3};
    Built after;
    const Topology good = optimize_treelets(services.host(), bad, refs.data(), {}, after.memory());
    const auto side = [](uint32_t ref) { return ref % 2; };
    EXPECT_EQ(side(after.refs[0]), side(after.refs[1]));
    EXPECT_EQ(side(after.refs[2]), side(after.refs[3]));
    EXPECT_LT(cost(good, boxes), 0.7 * cost(bad, boxes));
}

TEST(Treelets, GiveTheSameOnAnyNumberOfThreads) {
    Boxes boxes;
    boxes.add(30000, 1);
    std::vector<uint32_t> first;
    for (const unsigned threads : {1u, 2u, 5u}) {
        const bvh_test::Services services(threads);
        Built before, after;
        const Topology from = build_topology(services.host(), boxes.input(), {2, 32, 1, 1, Method::morton}, before.memory());
        optimize_treelets(services.host(), from, before.refs.data(), {}, after.memory());
        if (first.empty()) first = after.refs;
        EXPECT_EQ(first, after.refs);
    }
}
