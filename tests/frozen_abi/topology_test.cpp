// A topology that breaks its contract gets one clear error; a sound one is packed by its layout.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "rt_plugin.hpp"
#include "structures/accel_build.hpp"
#include "support/errors.hpp"
#include "support/generated.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

constexpr const char* kShapes[] = {"sound",      "large_leaves", "list",     "shared",    "circle",  "far_child", "far_leaf",
                                   "empty_leaf", "lost",         "bad_ref",  "deep",      "no_root", "no_tree",   "no_nodes",
                                   "no_refs",    "nodes_twice",  "far_root", "far_group", "fails",   nullptr};

// Builds a list of leaves of one primitive each: inner node i has leaf i and node i + 1. Its shape is what the parameter names.
int32_t build(const rt_host* host, const rt_build_input* in, const rt_topology_output* out) {
    const std::string shape = kShapes[static_cast<size_t>(in->params[0])];
    if (shape == "fails") throw rt::fail(host, "this builder always fails");
    const rt_u32 count = in->groups[0].count;
    const rt_u32 room = count + 1000;
    if (shape == "no_nodes") {
        rt::refs(out, count);
        return RT_OK;
    }
    rt_topology_node* nodes = rt::nodes(out, 2 * uint64_t(room));
    if (shape == "nodes_twice") rt::nodes(out, 1);
    if (shape == "no_refs") return RT_OK;
    rt_u32* refs = rt::refs(out, room);
    const rt_prim* const prims = in->prims + in->groups[0].first;
    for (rt_u32 i = 0; i < room; ++i) refs[i] = prims[i % count].ref;
    rt_topology_node all{{-10, -10, -10}, 0, {10, 10, 10}, 0};
    const auto leaf = [&](rt_u32 first, rt_u32 size) {
        rt_topology_node node = all;
        node.left = first;
        node.right = RT_TOPOLOGY_LEAF | size;
        return node;
    };
    if (shape == "large_leaves") {
        nodes[0] = leaf(0, count);
    } else {
        const rt_u32 last = shape == "deep" ? 400 : count - 1;  // number of inner nodes
        for (rt_u32 i = 0; i < last; ++i) {
            nodes[i] = all;
            nodes[i].left = room + i;
            nodes[i].right = i + 1 < last ? i + 1 : room + last;
            nodes[room + i] = leaf(i, 1);
        }
        nodes[room + last] = leaf(last, 1);
        if (shape == "shared") nodes[2].left = nodes[1].left;
        if (shape == "circle") nodes[3].right = 1;
        if (shape == "far_child") nodes[2].left = 5 * room;
        if (shape == "far_leaf") nodes[room + 2].left = room;
        if (shape == "empty_leaf") nodes[room + 2].right = RT_TOPOLOGY_LEAF;
        if (shape == "lost") nodes[2].right = room + 3;
        if (shape == "bad_ref") refs[3] = RT_REF_SPHERE | 77;
    }
    if (shape == "far_group") rt::root(out, in->group_count, 0);
    for (rt_u32 g = 0; g < in->group_count && shape != "no_root"; ++g)
        rt::root(out, g, shape == "no_tree" ? RT_NONE : shape == "far_root" ? 2 * room : 0);
    rt::stat(out, "refs", count);
    return RT_OK;
}

constexpr rt_param kParams[] = {rt::enum_param("shape", "Shape", "of the tree", kShapes, 0)};
constexpr rt_accel kAccel = rt::topology("bvh2", rt::guarded<build>, rt::Traits());
constexpr rt_plugin kPlugin = rt::accel_plugin("shaped", "Trees of odd shapes", "1.0", nullptr, kParams, kAccel);

ScenePtr scene() {
    return shared_scene(scene_of(box(1)));  // 12 triangles in one group
}

AccelData build_shape(const std::string& shape, bool with_layout = true) {
    Progress progress;
    ParameterValues params = default_parameters(kPlugin);
    set_parameter(kPlugin, params, "shape", shape);
    BuildTarget target;
    if (with_layout) target.layout = Workbench::get().plugins().accel("bvh2");
    return build_accel(*scene(), kPlugin, params, progress, target);
}

struct Breach {
    const char *shape, *says;
};
class BadTopology : public ::testing::TestWithParam<Breach> {};
TEST_P(BadTopology, IsOneClearError) {
    try {
        build_shape(GetParam().shape);
        FAIL() << "the tree was taken";
    } catch (const Error& e) {
        const std::string what = e.what();
        EXPECT_EQ(e.code(), Exit::failed);
        EXPECT_EQ(what.find("accel shaped: "), 0u) << what;
        EXPECT_NE(what.find(GetParam().says), std::string::npos) << what;
    }
}
INSTANTIATE_TEST_SUITE_P(Breaches, BadTopology,
                         testing::Values(Breach{"shared", "two parents"}, Breach{"circle", "circle"},
                                         Breach{"far_child", "named node 5060 of group 0, but asked for 2024 nodes"},
                                         Breach{"far_leaf", "refs 1012 to 1012, but asked for 1012 refs"},
                                         Breach{"empty_leaf", "leaf without refs"},
                                         Breach{"lost", "lost primitives of group 0: its leaves name 4 refs, it was given 12"},
                                         Breach{"bad_ref", "ref at place 3"}, Breach{"deep", "more than 256 nodes"},
                                         Breach{"no_root", "no root for group 0"},
                                         Breach{"no_tree", "no tree for group 0, which has 12 primitives"},
                                         Breach{"no_nodes", "never asked for nodes"}, Breach{"no_refs", "never asked for refs"},
                                         Breach{"nodes_twice", "nodes twice"}, Breach{"far_root", "named node 2024"},
                                         Breach{"far_group", "group 1 of 1"}, Breach{"fails", "always fails"}),
                         [](const testing::TestParamInfo<Breach>& info) { return info.param.shape; });

TEST(Topology, OfAnyShapeIsPacked) {
    for (const char* shape : {"sound", "list", "large_leaves"}) {
        const AccelData accel = build_shape(shape);
        EXPECT_STREQ(accel.plugin->id, "shaped");
        EXPECT_STREQ(accel.layout->id, "bvh2");
        EXPECT_EQ(accel.stat("refs"), 12) << "the builder's own statistics stay";
        EXPECT_GE(accel.stat("nodes"), 1);
        EXPECT_EQ(accel.defines.count("BVH2_STACK"), 1u);
        std::vector<rt_u32> refs;
        for (uint64_t i = 0; i < accel.leaf_count; ++i)
            refs.push_back(static_cast<const rt_packed_prim*>(accel.leaves.data())[i].ref);
        for (rt_u32 ref = 0; ref < 12; ++ref) EXPECT_NE(std::find(refs.begin(), refs.end(), ref), refs.end()) << ref;
    }
}

TEST(Topology, NeedsItsLayout) {
    expect_error([&] { build_shape("sound", false); }, {"layout 'bvh2' is not there"});
}

}  // namespace
