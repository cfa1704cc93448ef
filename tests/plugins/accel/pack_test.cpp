// pack_test.cpp -- any builder goes with any layout: each plugin packs the topologies of all builders.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "bvh2/pack.hpp"
#include "bvh2_check.hpp"
#include "bvh4/node_memory.hpp"
#include "bvh4/pack.hpp"
#include "bvh8/pack.hpp"
#include "clarity_bvh/assemble.hpp"
#include "clarity_bvh/build/builder.hpp"
#include "cwbvh/pack.hpp"
#include "leaf_tally.hpp"
#include "wide_check.hpp"

using namespace accel_test;
using namespace clarity::bvh;

namespace {

// A tree that halves the primitives in their order: a builder that knows nothing but a tree.
struct Halves {
    const rt_build_input& input;
    std::vector<rt_topology_node> nodes;
    std::vector<uint32_t> refs, roots;

    explicit Halves(const rt_build_input& in) : input(in) {
        for (rt_u32 g = 0; g < in.group_count; ++g)
            roots.push_back(in.groups[g].count > 0 ? make(in.groups[g].first, in.groups[g].count) : RT_NONE);
    }
    uint32_t make(uint32_t first, uint32_t count) {
        const auto index = static_cast<uint32_t>(nodes.size());
        nodes.emplace_back();
        if (count == 1) {
            std::copy_n(input.prims[first].lo, 3, nodes[index].lo);
            std::copy_n(input.prims[first].hi, 3, nodes[index].hi);
            nodes[index].left = static_cast<uint32_t>(refs.size());
            nodes[index].right = kLeaf | 1;
            refs.push_back(input.prims[first].ref);
            return index;
        }
        const uint32_t left = make(first, count / 2), right = make(first + count / 2, count - count / 2);
        nodes[index].left = left;
        nodes[index].right = right;
        return index;
    }
};

enum class Origin { sah, morton, halves };
Origin origin;
uint32_t max_leaf;
float traversal_cost;

using Pack = void (*)(const rt_host*, const rt_build_input&, Topology&, const rt_u32*, const rt_build_output*);

// A plugin's build() that packs a topology of another origin.
template <Pack pack>
int32_t build_packed(const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
    std::vector<uint32_t> refs;
    const RefMemory memory = [&](uint64_t count) {
        refs.resize(count + 1);
        return refs.data();
    };
    if (origin == Origin::halves) {
        const Halves tree(*input);
        Topology topology = assemble(host, trees_of(tree.nodes, tree.roots, tree.refs), max_leaf, memory);
        pack(host, *input, topology, refs.data(), out);
        return RT_OK;
    }
    const Rules rules{max_leaf, 32, traversal_cost, 1, origin == Origin::morton ? Method::morton : Method::sah};
    Topology topology = build_topology(host, *input, rules, memory);
    pack(host, *input, topology, refs.data(), out);
    return RT_OK;
}

template <Pack pack>
Built packed(const char* id, const Input& input, const Options& options = {}) {
    rt_plugin plugin = load(id);
    rt_accel accel = *plugin.accel;
    accel.build = rt::guarded<build_packed<pack>>;
    plugin.accel = &accel;
    return build(plugin, input, options);
}

Input several_groups() {
    Input input;
    for (const uint32_t count : {30000u, 0u, 1u, 2u, 9u, 700u}) {
        std::vector<rt_prim> group = scattered(count, 10, static_cast<float>(count), count);
        for (rt_prim& prim : group) prim.ref = static_cast<rt_u32>(input.prims.size() + (&prim - group.data()));
        input.add_group(group);
    }
    return input;
}

// Checks that every primitive is in one leaf of bvh4's tree, in boxes that hold it.
struct Checker4 {
    const Input& input;
    const Built& built;
    LeafTally leaves;
    std::string why;

    accel_test::Bounds visit(rt_u32 index, uint32_t group) {
        accel_test::Bounds all;
        const WideNode<4> node = bvh4::settled_node(static_cast<const WideNode<4>*>(built.slots[0]), index);
        each_child(node, [&](const float box[6], uint32_t child) {
            const accel_test::Bounds below =
                is_leaf(child) ? leaves.visit(leaf_first(child), leaf_count(child), group, why) : visit(child, group);
            for (int a = 0; a < 3; ++a)
                if (box[a] != below.lo[a] || box[3 + a] != below.hi[a]) why = "a box is not that of what is below";
            all.add(box, box + 3);
        });
        return all;
    }
    std::string run() {
        for (uint32_t g = 0; g < input.groups.size(); ++g) visit(built.roots[g], g);
        return why.empty() ? leaves.missing() : why;
    }
};

}  // namespace

TEST(Pack, EveryLayoutTakesTheTreesOfEveryBuilder) {
    const Input input = several_groups();
    for (const Origin from : {Origin::sah, Origin::morton, Origin::halves})
        for (const uint32_t leaf : {1u, 4u}) {
            origin = from;
            max_leaf = leaf;
            traversal_cost = 1;
            EXPECT_EQ(check_bvh2(input, packed<bvh2::pack>("bvh2", input), leaf, from != Origin::morton), "");
            EXPECT_EQ(check_bvh8(input, packed<bvh8::pack>("bvh8", input)), "");
            EXPECT_EQ(check_cwbvh(input, packed<cwbvh::pack>("cwbvh", input)), "");
            const Built wide4 = packed<bvh4::pack>("bvh4", input);
            EXPECT_EQ((Checker4{input, wide4, {input, wide4}, {}}.run()), "");
        }
}

// A plugin's own build decides and writes part by part, and packing a finished topology gives the same.
TEST(Pack, ATopologyBuiltBeforehandGivesTheSameTree) {
    const Input input = several_groups();
    origin = Origin::sah;
    max_leaf = 4;
    traversal_cost = 3.0f / 7;
    const Options options{{{"max_leaf", 4}, {"intersection_cost", 1}}, 2, {}};
    Built own = build(load("bvh8"), input, options), other = packed<bvh8::pack>("bvh8", input, options);
    ASSERT_EQ(own.slot_counts, other.slot_counts);
    EXPECT_EQ(own.leaves, other.leaves);
    EXPECT_EQ(own.roots, other.roots);
    EXPECT_EQ(own.defines, other.defines);
    EXPECT_EQ(std::memcmp(own.slots[0], other.slots[0], own.slot_counts[0] * sizeof(bvh8_node)), 0);
    own.stats.erase("build_bytes");
    other.stats.erase("build_bytes");
    EXPECT_EQ(own.stats, other.stats);
}

TEST(Pack, TheLibraryMeasuresWhatThePluginReports) {
    Input input;
    input.add_group(bumpy_sphere(20000));
    const Built built = build(load("bvh2"), input);
    static double cost, leaves;
    rt_plugin plugin = load("bvh2");
    rt_accel accel = *plugin.accel;
    accel.build = [](const rt_host* host, const rt_build_input* in, const rt_build_output* out) -> int32_t {
        const Topology topology = build_topology(host, *in, {4, 32, 1, 1}, [&](uint64_t n) { return rt::leaves(out, n); });
        const Quality quality = measure(topology, in->groups, 1, 1);
        cost = quality.sah_cost;
        leaves = static_cast<double>(quality.leaves);
        return RT_OK;
    };
    plugin.accel = &accel;
    build(plugin, input);
    EXPECT_NEAR(cost, built.stats.at("sah_cost"), 1e-9 * cost);
    EXPECT_EQ(leaves, built.stats.at("leaves"));
}
