// assemble_test.cpp -- topologies of other builders' trees: every ref is kept, boxes hold what is below, and what is no tree is
// refused with its reason.
#include "clarity_bvh/assemble.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <stdexcept>

#include "services.hpp"

using namespace clarity::bvh;

namespace {

// A random tree over `count` refs: unevenly split, with leaves of up to `most` refs, nodes and refs in any order.
struct RandomTree {
    std::vector<rt_topology_node> nodes;
    std::vector<uint32_t> refs;
    std::mt19937 random;

    RandomTree(uint32_t count, uint32_t most, unsigned seed) : random(seed) {
        for (uint32_t i = 0; i < count; ++i) refs.push_back(1000 + i);
        std::shuffle(refs.begin(), refs.end(), random);
        make(0, count, most);
    }
    rt_topology trees(const std::vector<uint32_t>& roots) const { return trees_of(nodes, roots, refs); }

    static Bounds box_of(uint32_t ref) {
        const auto x = static_cast<float>(ref % 97), y = static_cast<float>(ref % 89), z = static_cast<float>(ref % 83);
        const float lo[3] = {x, y, z}, hi[3] = {x + 1, y + 2, z + 3};
        Bounds box;
        box.add(lo, hi);
        return box;
    }

 private:
    uint32_t make(uint32_t first, uint32_t count, uint32_t most) {
        const auto index = static_cast<uint32_t>(nodes.size());
        nodes.push_back({});  // the boxes of inner nodes stay zero: nobody reads them
        if (count <= most) {
            Bounds box;
            for (uint32_t i = first; i < first + count; ++i) box.add(box_of(refs[i]));
            for (int a = 0; a < 3; ++a) {
                nodes[index].lo[a] = box.lo[a];
                nodes[index].hi[a] = box.hi(a);
            }
            nodes[index].left = first;
            nodes[index].right = kLeaf | count;
            return index;
        }
        const uint32_t left = 1 + random() % (count - 1);
        // The left child has the later refs, every other time.
        const bool later = random() % 2;
        const uint32_t a = make(later ? first + left : first, later ? count - left : left, most);
        const uint32_t b = make(later ? first : first + left, later ? left : count - left, most);
        nodes[index].left = a;
        nodes[index].right = b;
        return index;
    }
};

// What a walk through a topology finds.
struct Walk {
    const Topology& topology;
    const std::vector<uint32_t>& refs;
    uint32_t max_leaf;
    std::vector<uint32_t> found, nodes;
    uint32_t depth = 0;
    std::string why;

    Bounds visit(uint32_t child, uint32_t level) {
        Bounds box;
        if (is_leaf(child)) {
            depth = std::max(depth, level);
            if (leaf_count(child) < 1 || leaf_count(child) > max_leaf) why = "leaf of " + std::to_string(leaf_count(child));
            for (uint32_t i = leaf_first(child); i < leaf_first(child) + leaf_count(child); ++i) {
                if (i != found.size()) why = "refs are not in the order of the leaves";
                found.push_back(refs.at(i));
                box.add(RandomTree::box_of(refs.at(i)));
            }
            return box;
        }
        nodes.push_back(child);
        const Node& node = topology.nodes.data()[child];
        if (node.work0 != 0 || node.work1 != 0) why = "the packer's words are not zero";
        const uint32_t code[2] = {node.child0, node.child1};
        const float* const boxes[2] = {node.box0, node.box1};
        // The refs of child 0 come first.
        for (int c = 0; c < 2; ++c) {
            const Bounds below = visit(code[c], level + 1);
            for (int a = 0; a < 3; ++a)
                if (boxes[c][a] > below.lo[a] || boxes[c][3 + a] < below.hi(a)) why = "a box does not hold what is below";
            box.add(boxes[c], boxes[c] + 3);
        }
        return box;
    }
};

void expect_sound(const RandomTree& tree, uint32_t max_leaf, unsigned threads) {
    const bvh_test::Services services(threads);
    std::vector<uint32_t> refs;
    const uint32_t root = 0;
    const Topology topology = assemble(services.host(), tree.trees({root}), max_leaf, [&](uint64_t count) {
        refs.resize(count);
        return refs.data();
    });
    EXPECT_EQ(topology.ref_count, tree.refs.size());
    Walk walk{topology, refs, max_leaf, {}, {}, 0, {}};
    walk.visit(topology.roots[0].code, 0);
    EXPECT_EQ(walk.why, "");
    EXPECT_EQ(walk.nodes.size(), topology.node_count());
    EXPECT_EQ(std::max(walk.depth, 1u), topology.depth);
    std::vector<uint32_t> found = walk.found, expected = tree.refs;
    std::sort(found.begin(), found.end());
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(found, expected);
    // Parts and tops name every node once.
    std::vector<uint32_t> named;
    for (const Part& part : topology.parts)
        for (uint32_t i = 0; i < part.node_count; ++i) named.push_back(part.first_node + i);
    for (const Top& top : topology.tops) named.push_back(top.node);
    std::sort(named.begin(), named.end());
    std::sort(walk.nodes.begin(), walk.nodes.end());
    EXPECT_EQ(named, walk.nodes);
}

std::string refusal(const std::vector<rt_topology_node>& nodes, uint64_t ref_count, uint32_t root = 0, uint32_t max_leaf = 7) {
    const bvh_test::Services services;
    const std::vector<uint32_t> refs(ref_count);
    std::vector<uint32_t> out;
    try {
        assemble(services.host(), trees_of(nodes, {root}, refs), max_leaf, [&](uint64_t count) {
            out.resize(count);
            return out.data();
        });
    } catch (const std::invalid_argument& e) {
        return e.what();
    }
    return "accepted";
}

rt_topology_node leaf(uint32_t first, uint32_t count) {
    return {{0, 0, 0}, first, {1, 1, 1}, kLeaf | count};
}
rt_topology_node inner(uint32_t left, uint32_t right) {
    return {{}, left, {}, right};
}

}  // namespace

TEST(Assemble, KeepsEveryRefOfRandomTrees) {
    for (const uint32_t count : {1u, 2u, 7u, 8u, 100u, 20000u})
        for (const uint32_t most : {1u, 4u, 50u})
            for (const uint32_t max_leaf : {1u, 3u, 7u})
                for (const unsigned threads : {1u, 4u}) expect_sound(RandomTree(count, most, count + most), max_leaf, threads);
}

TEST(Assemble, LargeLeavesBecomeBalancedTrees) {
    const bvh_test::Services services;
    const std::vector<rt_topology_node> nodes{leaf(0, 1000)};
    const std::vector<uint32_t> refs(1000, 5);
    std::vector<uint32_t> out(1000);
    const Topology topology = assemble(services.host(), trees_of(nodes, {0}, refs), 4, [&](uint64_t) { return out.data(); });
    EXPECT_EQ(topology.node_count(), 249u);
    EXPECT_EQ(topology.depth, 8u);
}

TEST(Assemble, GroupsMayBeEmptyOrOneLeaf) {
    const bvh_test::Services services;
    const std::vector<rt_topology_node> nodes{leaf(0, 1), leaf(1, 2)};
    const std::vector<uint32_t> refs{7, 8, 9};
    std::vector<uint32_t> out(3);
    const Topology topology =
        assemble(services.host(), trees_of(nodes, {1, RT_NONE, 0}, refs), 7, [&](uint64_t) { return out.data(); });
    EXPECT_EQ(topology.roots[0].code, make_leaf(0, 2));
    EXPECT_EQ(topology.roots[1].code, RT_NONE);
    EXPECT_EQ(topology.roots[2].code, make_leaf(2, 1));
    EXPECT_EQ(out, (std::vector<uint32_t>{8, 9, 7}));
}

TEST(Assemble, BoxesOfAnyNumbersBecomeFinite) {
    const bvh_test::Services services;
    std::vector<rt_topology_node> nodes{inner(1, 2), leaf(0, 1), leaf(1, 1)};
    nodes[1].lo[0] = NAN;
    nodes[1].hi[1] = INFINITY;
    nodes[2].lo[2] = 3;  // above its upper bound
    const std::vector<uint32_t> refs{7, 8};
    std::vector<uint32_t> out(2);
    const Topology topology = assemble(services.host(), trees_of(nodes, {0}, refs), 7, [&](uint64_t) { return out.data(); });
    const Bounds& box = topology.roots[0].box;
    EXPECT_EQ(box.lo[0], -FLT_MAX);
    EXPECT_EQ(box.hi(1), FLT_MAX);
    EXPECT_EQ(box.hi(2), 3);
}

TEST(Assemble, RefusesWhatIsNoTree) {
    EXPECT_EQ(refusal({inner(1, 2), leaf(0, 1), leaf(1, 1)}, 2), "accepted");
    const auto expect = [](const std::string& why, const char* part) { EXPECT_NE(why.find(part), std::string::npos) << why; };
    expect(refusal({inner(1, 5), leaf(0, 1)}, 1), "node 5 is named, but there are 2");
    expect(refusal({inner(1, 1), leaf(0, 1)}, 1), "node 1 has two parents");
    expect(refusal({inner(1, 0), leaf(0, 1)}, 1), "node 0 has two parents, or a circle");
    expect(refusal({leaf(0, 0)}, 1), "leaf node 0 has no refs");
    expect(refusal({leaf(3, 4)}, 6), "leaf node 0 has refs 3 to 6, but there are 6");
    expect(refusal({leaf(0xFFFFFFFFu, 0x7FFFFFFFu)}, 6), "but there are 6");
    expect(refusal({leaf(0, 1)}, 1, 9), "node 9 is named");
    expect(refusal({leaf(0, 1)}, 1, 0, 8), "max_leaf is 8");
    std::vector<rt_topology_node> chain;
    for (uint32_t i = 0; i < 300; ++i) {
        chain.push_back(inner(2 * i + 1, 2 * i + 2));
        chain.push_back(leaf(i, 1));
    }
    chain.push_back(leaf(300, 1));
    expect(refusal(chain, 301), "split more evenly");
}
