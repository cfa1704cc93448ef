// Instances that a user moves, turns, scales and hides: at rest, in poses, and what copies of a scene share.
#include "scene/instance_edit.hpp"

#include <gtest/gtest.h>

#include "scene/motion/pose.hpp"

namespace clarity {
namespace {

// Two tetrahedra; the second one hangs on a node that a clip moves by 10 along x within a second.
Scene two_placed() {
    Scene scene;
    scene.positions = {0, 0, 0, 2, 0, 0, 0, 4, 0, 0, 0, 6};
    scene.triangles = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    scene.triangle_materials = {0, 0, 0, 0};
    scene.texels = {1, 2, 3};
    scene.materials.push_back({"default", default_material()});
    scene.meshes.push_back({"tetrahedron", 0, 4, 0, 4, 4});
    scene.instances.resize(2);
    scene.instances[1].node = 0;
    Node node;
    node.values.parent = RT_NONE;
    for (double& s : node.values.scale) s = 1;
    for (auto* matrix : {&node.values.before_rotation, &node.values.after_rotation, &node.values.after_scale})
        for (int k = 0; k < 3; ++k) (*matrix)[5 * k] = 1;
    Motion& m = scene.motion;
    m.nodes = {node};
    m.key_times = {0, 1};
    m.key_values = {0, 10};
    m.key_spans = {RT_SPAN_LINEAR, RT_SPAN_LINEAR};
    m.clips.push_back({"slide", 0, 0, 1, 0, 1, 24});
    m.layers.push_back({RT_LAYER_REPLACES, 0, 1});
    Channel c;
    c.moves = RT_MOVES_TRANSLATION;
    c.key_count = 2;
    m.channels = {c};
    EXPECT_EQ(validate(scene), "");
    return scene;
}

std::array<float, 3> middle(const Affine& world) {
    const float m[3] = {1, 2, 3};
    return transform_point(world, m);
}

TEST(InstanceEdit, ShiftsGoOnTopOfThePose) {
    const Scene rest = two_placed();
    InstanceEdits edits;
    edits.set_shift(1, {{0, 5, 0}, {0, 0, 90}, {2, 2, 2}});
    const Scene edited = with_edits(rest, edits);
    EXPECT_EQ(validate(edited), "");
    EXPECT_EQ(edited.instances[0].world_from_object, kIdentity);
    EXPECT_FALSE(edited.instances[0].apart);
    EXPECT_TRUE(edited.instances[1].apart);
    EXPECT_EQ(middle(edited.instances[1].world_from_object), (std::array<float, 3>{1, 7, 3})) << "it turns about its middle";
    const Affine& world = edited.instances[1].world_from_object;
    EXPECT_NEAR(world[4], 2, 1e-6) << "x becomes y, twice as long";
    EXPECT_NEAR(world[1], -2, 1e-6);
    EXPECT_NEAR(world[10], 2, 1e-6);

    const Pose pose = evaluate(edited, "slide", 0.5);
    EXPECT_EQ(middle(pose.instances[1].world_from_object), (std::array<float, 3>{6, 7, 3}));
    const Scene posed_scene = posed(edited, pose);
    EXPECT_TRUE(posed_scene.instances[1].apart);
    EXPECT_EQ(evaluate(rest, "slide", 0.5).instances[1].world_from_object[3], 5) << "the imported scene is as before";
}

TEST(InstanceEdit, HiddenInstancesStayHiddenInPoses) {
    const Scene rest = two_placed();
    const Scene edited = with_edits(rest, {{}, {0, 1}});
    EXPECT_FALSE(edited.instances[1].visible);
    const Pose pose = evaluate(edited, "slide", 0.25);
    EXPECT_FALSE(pose.instances[0].visible);
    EXPECT_FALSE(pose.instances[1].visible);
}

TEST(InstanceEdit, CopiesShareWhatIsLarge) {
    const Scene rest = two_placed();
    InstanceEdits edits;
    edits.set_shift(0, {{1, 0, 0}, {}, {1, 1, 1}});
    const Scene edited = with_edits(rest, edits), moved = posed(edited, evaluate(edited, "slide", 1));
    for (const Scene* scene : {&edited, &moved}) {
        EXPECT_TRUE(scene->positions.shares(rest.positions));
        EXPECT_TRUE(scene->triangles.shares(rest.triangles));
        EXPECT_TRUE(scene->texels.shares(rest.texels));
    }
    Scene changed = edited;
    changed.positions.own()[0] = 9;
    EXPECT_EQ(rest.positions[0], 0) << "a copy that is changed is a copy";
    EXPECT_EQ(changed.positions[0], 9);
    EXPECT_TRUE(changed.texels.shares(rest.texels));
}

TEST(InstanceEdit, AListKeepsItsOrderAndForgetsShiftsThatDoNothing) {
    InstanceEdits edits;
    edits.set_shift(7, {{1, 0, 0}, {}, {1, 1, 1}});
    edits.set_shift(2, {{2, 0, 0}, {}, {1, 1, 1}});
    ASSERT_EQ(edits.moved.size(), 2u);
    EXPECT_EQ(edits.moved[0].instance, 2u);
    EXPECT_EQ(edits.shift_of(7).translate[0], 1);
    edits.set_shift(7, {});
    EXPECT_EQ(edits.moved.size(), 1u);
    edits.hide(4, true);
    edits.hide(1, true);
    edits.hide(4, true);
    EXPECT_EQ(edits.hidden, (std::vector<rt_u32>{1, 4}));
    edits.hide(4, false);
    EXPECT_FALSE(edits.is_hidden(4));
    edits.set_shift(2, {});
    edits.hide(1, false);
    EXPECT_TRUE(edits.empty());
}

}  // namespace
}  // namespace clarity
