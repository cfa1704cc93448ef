// pose_test.cpp -- poses of small scenes that are made here.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "scene/motion/matrix.hpp"
#include "scene/motion/pose.hpp"
#include "support/errors.hpp"

namespace clarity {
namespace {

rt_node_desc still_node(rt_u32 parent) {
    rt_node_desc node{};
    node.parent = parent;
    for (double& s : node.scale) s = 1;
    for (auto* matrix : {&node.before_rotation, &node.after_rotation, &node.after_scale})
        std::copy(kIdentityMatrix.begin(), kIdentityMatrix.end(), *matrix);
    return node;
}

// One triangle on node 1, whose parent is node 0.
class PoseTest : public testing::Test {
 protected:
    PoseTest() {
        scene_.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
        scene_.triangles = {0, 1, 2};
        scene_.triangle_materials = {0};
        scene_.materials.push_back({"default", default_material()});
        scene_.meshes.push_back({"triangle", 0, 3, 0, 1, 1});
        Instance instance;
        instance.node = 1;
        instance.root = 0;
        scene_.instances.push_back(instance);
        scene_.motion.nodes = {{"root", still_node(RT_NONE)}, {"node", still_node(0)}};
    }
    void clip(const std::string& name, rt_u32 layers = 1, rt_u32 rig = 0) {
        Motion& m = scene_.motion;
        m.clips.push_back({name, rig, rt_u32(m.layers.size()), layers, 0, 1, 24});
        m.layers.resize(m.layers.size() + layers, {RT_LAYER_REPLACES, 0, 1});
    }
    // A linear channel from 0 to 1 s.
    void key(rt_u32 moves, rt_u32 target, rt_u32 component, double from, double to, rt_u32 layer = 0) {
        Motion& m = scene_.motion;
        Channel c;
        c.clip = rt_u32(m.clips.size() - 1);
        c.layer = layer;
        c.moves = moves;
        c.target = target;
        c.component = component;
        c.first_key = m.key_times.size();
        c.first_value = m.key_values.size();
        c.key_count = 2;
        for (const double time_s : {0.0, 1.0}) m.key_times.push_back(time_s);
        for (const double value : {from, to}) m.key_values.push_back(value);
        m.key_spans.resize(m.key_times.size(), RT_SPAN_LINEAR);
        m.channels.push_back(c);
    }
    std::array<float, 3> corner(const Scene& scene, int number) const {
        return transform_point(scene.instances[0].world_from_object, &scene.positions[3 * number]);
    }
    Scene at(double time_s, const std::string& name = "") {
        EXPECT_EQ(validate(scene_), "");
        return posed(scene_, evaluate(scene_, name, time_s));
    }
    Scene scene_;
};

TEST_F(PoseTest, ChildrenFollowTheirParents) {
    clip("move");
    key(RT_MOVES_TRANSLATION, 0, 0, 0, 10);
    key(RT_MOVES_ROTATION, 1, 2, 0, 90);
    const auto p = corner(at(1), 1);
    EXPECT_NEAR(p[0], 10, 1e-5);
    EXPECT_NEAR(p[1], 1, 1e-5);
    EXPECT_EQ(corner(scene_, 1)[0], 1) << "the scene itself stays at rest";
}

TEST_F(PoseTest, OneClipActsAtATime) {
    clip("left");
    key(RT_MOVES_TRANSLATION, 1, 0, 0, -5);
    clip("right");
    key(RT_MOVES_TRANSLATION, 1, 0, 0, 5);
    EXPECT_NEAR(corner(at(1), 0)[0], -5, 1e-5) << "the first one acts where none is named";
    EXPECT_NEAR(corner(at(1, "right"), 0)[0], 5, 1e-5);
    expect_error([&] { evaluate(scene_, "up", 0); }, {"left, right"}, Exit::usage);
}

TEST_F(PoseTest, LayersAddAndBlend) {
    clip("layers", 3);
    scene_.motion.layers[1] = {RT_LAYER_ADDS, 0, 0.5};
    scene_.motion.layers[2] = {RT_LAYER_BLENDS, 0, 0.25};
    key(RT_MOVES_TRANSLATION, 1, 0, 4, 4, 0);
    key(RT_MOVES_TRANSLATION, 1, 0, 8, 8, 1);
    EXPECT_NEAR(corner(at(0), 0)[0], 8, 1e-5) << "4 + 0.5 * 8";
    key(RT_MOVES_TRANSLATION, 1, 0, 0, 0, 2);
    EXPECT_NEAR(corner(at(0), 0)[0], 6, 1e-5) << "a quarter of the way from 8 to 0";
}

TEST_F(PoseTest, MorphsInterpolateBetweenTargets) {
    Motion& m = scene_.motion;
    m.morphs.push_back({"lift", 0, 0, 2, 0});
    m.morph_targets = {{0.5, 0, 1, 0, 0, 0}, {1, 1, 1, 0, 0, 0}};
    m.morph_vertices = {1, 1};
    m.morph_positions = {0, 0, 4, 0, 0, 6};
    clip("morph");
    key(RT_MOVES_MORPH, 0, 0, 0, 2);
    EXPECT_NEAR(corner(at(0.125), 1)[2], 2, 1e-5) << "half the way to the target at 0.5";
    EXPECT_NEAR(corner(at(0.25), 1)[2], 4, 1e-5);
    EXPECT_NEAR(corner(at(0.375), 1)[2], 5, 1e-5) << "between the targets";
    EXPECT_NEAR(corner(at(1), 1)[2], 10, 1e-5) << "straight on beyond the last one";
    EXPECT_EQ(corner(at(1), 0)[2], 0);
}

TEST_F(PoseTest, WeightsAreDividedByTheirSum) {
    Motion& m = scene_.motion;
    Skin skin;
    skin.root = RT_NONE;
    skin.bone_count = 2;
    skin.weight_count = 3;
    m.skins.push_back(skin);
    m.bones.resize(2);
    for (Bone& bone : m.bones) std::copy(kIdentityMatrix.begin(), kIdentityMatrix.end(), bone.bone_from_mesh);
    m.bones[1].node = 1;
    m.weights = {{0, 1, 0.25f}, {1, 0, 0.1f}, {1, 1, 0.3f}};
    clip("skin");
    key(RT_MOVES_TRANSLATION, 1, 1, 0, 8);
    const Scene scene = at(1);
    EXPECT_NEAR(corner(scene, 0)[1], 8, 1e-5) << "one weight of 0.25 counts fully";
    EXPECT_NEAR(corner(scene, 1)[1], 6, 1e-5) << "three quarters of 8";
    EXPECT_NEAR(corner(scene, 2)[1], 1 + 8, 1e-5) << "a vertex without weights stays with its node";
}

// At rest bones and the weights of morphs act as stored; poses start from the vertices of the file nevertheless.
TEST_F(PoseTest, AtRestSkinsAndMorphsActAsStored) {
    Motion& m = scene_.motion;
    Skin skin;
    skin.root = 0;
    skin.bone_count = 1;
    skin.weight_count = 3;
    m.skins.push_back(skin);
    m.bones.resize(1);
    std::copy(kIdentityMatrix.begin(), kIdentityMatrix.end(), m.bones[0].bone_from_mesh);
    m.bones[0].node = 2;
    m.weights = {{0, 0, 1}, {1, 0, 1}, {2, 0, 1}};
    m.nodes.push_back({"bone", still_node(0)});
    m.nodes[2].values.translation[2] = 4;
    m.nodes[1].values.translation[0] = 100;  // the node of the instance, which the skin makes of no effect
    m.nodes[0].values.translation[1] = 7;    // the placement of the file
    scene_.instances[0].world_from_object[3] = 100;
    m.morphs.push_back({"grow", 0, 0, 1, 0.5});
    m.morph_targets.push_back({1, 0, 1, 0, 0, 0});
    m.morph_vertices = {1};
    m.morph_positions = {2, 0, 0};
    clip("move");
    key(RT_MOVES_TRANSLATION, 2, 2, 10, 20);
    const Scene stored = scene_;
    EXPECT_EQ(deform_at_rest(scene_, {true}), 0u);
    EXPECT_EQ(scene_.positions, stored.positions) << "the mesh is to stay as stored";
    EXPECT_TRUE(scene_.motion.stored.empty());
    EXPECT_EQ(deform_at_rest(scene_, {false}), 0u);
    EXPECT_EQ(validate(scene_), "");
    ASSERT_EQ(scene_.motion.stored.size(), 1u);
    EXPECT_EQ(corner(scene_, 0), (std::array<float, 3>{0, 7, 4}));
    EXPECT_EQ(corner(scene_, 1), (std::array<float, 3>{2, 7, 4})) << "the morph moves it by a half of 2";
    EXPECT_FALSE(scene_.positions.shares(stored.positions));
    for (const double time_s : {0.0, 0.5, 1.0}) {
        const Scene from_rest = at(time_s), from_stored = posed(stored, evaluate(stored, "", time_s));
        EXPECT_EQ(from_rest.positions, from_stored.positions);
        EXPECT_EQ(from_rest.instances[0].world_from_object, from_stored.instances[0].world_from_object);
    }
    EXPECT_EQ(corner(at(1), 1), (std::array<float, 3>{2, 7, 20}));
    scene_.motion.stored[0].first = 1;
    EXPECT_NE(validate(scene_), "") << "vertices past the last one";
}

TEST_F(PoseTest, AtRestNothingIsCopiedWhereNothingDeforms) {
    scene_.motion.morphs.push_back({"grow", 0, 0, 1, 0});
    scene_.motion.morph_targets.push_back({1, 0, 1, 0, 0, 0});
    scene_.motion.morph_vertices = {1};
    scene_.motion.morph_positions = {2, 0, 0};
    const Scene before = scene_;
    EXPECT_EQ(deform_at_rest(scene_, {false}), 0u);
    EXPECT_TRUE(scene_.positions.shares(before.positions));
    EXPECT_TRUE(scene_.motion.stored.empty());
}

TEST_F(PoseTest, VertexFramesReplaceTheVertices) {
    Motion& m = scene_.motion;
    m.frames.push_back({0, 0, 0, 2, 0});
    m.frame_times = {0, 1};
    m.frame_positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 4, 1, 0, 4, 0, 1, 4};
    EXPECT_NEAR(corner(at(0.5), 2)[2], 2, 1e-5);
    EXPECT_NEAR(corner(at(7), 2)[2], 4, 1e-5);
}

TEST_F(PoseTest, FlattenedInstancesAreBaked) {
    clip("flat");
    key(RT_MOVES_SCALE, 1, 2, 1, 0);
    const Scene scene = at(1);
    EXPECT_EQ(validate(scene), "");
    EXPECT_EQ(scene.meshes.size(), 2u);
    EXPECT_NEAR(corner(at(0.5), 1)[0], 1, 1e-5);
}

TEST_F(PoseTest, HiddenNodesHideTheirChildren) {
    clip("hide");
    key(RT_MOVES_VISIBILITY, 0, 0, 1, 0);
    EXPECT_TRUE(at(0).instances[0].visible);
    EXPECT_FALSE(at(1).instances[0].visible);
    scene_.motion.nodes[1].values.flags = RT_NODE_OWN_VISIBILITY;
    EXPECT_TRUE(at(1).instances[0].visible);
}

TEST_F(PoseTest, DamagedMotionIsFound) {
    clip("move");
    key(RT_MOVES_TRANSLATION, 1, 0, 0, 1);
    const auto why = [&](auto&& damage) {
        Scene damaged = scene_;
        damage(damaged.motion);
        return validate(damaged);
    };
    EXPECT_NE(why([](Motion& m) { m.channels[0].target = 2; }), "");
    EXPECT_NE(why([](Motion& m) { m.channels[0].key_count = 3; }), "");
    EXPECT_NE(why([](Motion& m) { m.channels[0].key_count = uint64_t(1) << 62; }), "");
    EXPECT_NE(why([](Motion& m) { m.key_times.own()[1] = -1; }), "");
    EXPECT_NE(why([](Motion& m) { m.nodes[0].values.parent = 1; }), "");
    EXPECT_NE(why([](Motion& m) { m.clips[0].layer_count = 2; }), "");
}

}  // namespace
}  // namespace clarity
