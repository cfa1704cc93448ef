// Which poses need a new Scene object, and so a new structure. No screen is needed.
#include "ui/threads/shown_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace clarity::ui {
namespace {

rt_node_desc still_node() {
    rt_node_desc node{};
    node.parent = RT_NONE;
    for (double& s : node.scale) s = 1;
    for (auto* matrix : {&node.before_rotation, &node.after_rotation, &node.after_scale})
        for (int k = 0; k < 3; ++k) (*matrix)[5 * k] = 1;
    return node;
}

// A triangle, a light and a camera. Clip "light" moves the last two, clip "all" the triangle too; they share node 0.
class ShownSceneTest : public ::testing::Test {
 protected:
    ShownSceneTest() : loaded_(std::make_shared<ImportedScene>()), shown_(plugins_, {}) {
        Scene scene;
        scene.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
        scene.triangles = {0, 1, 2};
        scene.triangle_materials = {0};
        scene.materials.push_back({"default", default_material()});
        scene.meshes.push_back({"triangle", 0, 3, 0, 1, 1});
        Instance instance;
        instance.node = 1;
        scene.instances = {instance, instance};
        scene.instances[1].node = RT_NONE;
        Camera camera;
        camera.node = 0;
        camera.eye = camera.node_eye = {0, 0, 5};
        camera.node_up = {0, 1, 0};
        scene.cameras.push_back(camera);
        Light light;
        light.node = 0;
        scene.lights.push_back(light);
        Motion& m = scene.motion;
        m.nodes = {{"camera", still_node()}, {"triangle", still_node()}};
        m.key_times = {0, 1};
        m.key_values = {0, 10};
        m.key_spans = {RT_SPAN_LINEAR, RT_SPAN_LINEAR};
        for (rt_u32 clip = 0; clip < 2; ++clip) {
            m.clips.push_back({clip == 0 ? "light" : "all", 0, clip, 1, 0, 1, 24});
            m.layers.push_back({RT_LAYER_REPLACES, 0, 1});
            for (rt_u32 node = 0; node <= clip; ++node) {
                Channel c;
                c.clip = clip;
                c.target = node;
                c.moves = RT_MOVES_TRANSLATION;
                c.key_count = 2;
                m.channels.push_back(c);
            }
        }
        EXPECT_EQ(validate(scene), "");
        loaded_->scene = std::make_shared<const Scene>(std::move(scene));
    }
    void show(const PoseTime& pose, const std::vector<rt_u32>& hidden = {}) {
        PrepareRequest request;
        request.pose = pose;
        request.instances.hidden = hidden;
        shown_.update(loaded_, request);
    }
    const PluginRegistry plugins_ = PluginRegistry::of({});
    std::shared_ptr<ImportedScene> loaded_;
    ShownScene shown_;
};

TEST_F(ShownSceneTest, CamerasAndLightsAloneNeedNoNewScene) {
    show({});
    EXPECT_EQ(shown_.scene(), loaded_->scene);
    show({0.5, "light"});
    EXPECT_EQ(shown_.scene(), loaded_->scene);
    EXPECT_EQ(shown_.cameras()[0].eye[0], 5);
    EXPECT_EQ(shown_.lights()[0].values.position[0], 5);
    show({0.5, "all"});
    const auto moved = shown_.scene();
    EXPECT_NE(moved, loaded_->scene);
    EXPECT_EQ(moved->instances[0].world_from_object[3], 5);
    show({0.5, "all"});
    EXPECT_EQ(shown_.scene(), moved);
    show({});
    EXPECT_EQ(shown_.scene(), loaded_->scene);
    EXPECT_EQ(shown_.lights()[0].values.position[0], 0);
}

// Devices make vertices themselves, so they are made here for those only that ask.
TEST_F(ShownSceneTest, VerticesAreMadeWhenSomeoneNeedsThem) {
    auto loaded = std::make_shared<ImportedScene>(*loaded_);
    Scene scene = *loaded->scene;
    Motion& m = scene.motion;
    m.frames.push_back({0, 0, 0, 2, 0});
    m.frame_times = {0, 1};
    m.frame_positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 4, 1, 0, 4, 0, 1, 4};
    ASSERT_EQ(validate(scene), "");
    loaded->scene = std::make_shared<const Scene>(std::move(scene));
    loaded_ = loaded;
    show({0.5, "light"});
    const auto light = shown_.scene();
    EXPECT_NE(light, loaded_->scene);
    EXPECT_TRUE(light->positions.shares(loaded_->scene->positions)) << "nothing was copied";
    ASSERT_EQ(shown_.left_out().size(), 1u);
    Ready ready;
    ready.scene = light;
    ready.rest = shown_.rest();
    ready.left_out = shown_.left_out();
    EXPECT_EQ(whole_scene(ready)->positions[2], 2) << "half the way to the second frame";
    EXPECT_NE(left_out(ready, 0), nullptr);
    shown_.add_vertices();
    const auto whole = shown_.scene();
    EXPECT_EQ(whole->positions[2], 2);
    EXPECT_TRUE(shown_.left_out().empty());
    show({0.5, "light"});
    shown_.add_vertices();
    EXPECT_EQ(shown_.scene(), whole) << "the same pose needs no other object";
    show({0.75, "light"});
    EXPECT_EQ(shown_.left_out().size(), 1u);
    EXPECT_EQ(shown_.scene()->positions[2], 0);
    show({});
    EXPECT_EQ(shown_.scene(), loaded_->scene);
}

TEST_F(ShownSceneTest, HiddenInstancesStayHiddenInEveryPose) {
    show({0.5, "all"}, {1});
    EXPECT_FALSE(shown_.scene()->instances[1].visible);
    const auto before = shown_.scene();
    show({1.0, "all"}, {1});
    EXPECT_NE(shown_.scene(), before);
    EXPECT_FALSE(shown_.scene()->instances[1].visible);
    show({1.0, "all"});
    EXPECT_TRUE(shown_.scene()->instances[1].visible);
}

TEST_F(ShownSceneTest, AClipThatIsMissingChangesNothing) {
    show({1.0, "all"});
    const auto before = shown_.scene();
    EXPECT_ANY_THROW(show({1.0, "none"}));
    EXPECT_EQ(shown_.scene(), before);
    EXPECT_EQ(shown_.pose().clip, "all");
    // A request for files that could not be read keeps what is shown.
    PrepareRequest other;
    other.files_revision = 7;
    shown_.update(loaded_, other);
    EXPECT_EQ(shown_.scene(), before);
}

TEST_F(ShownSceneTest, EditsAreFollowedFromTheFirstOneOn) {
    PrepareRequest request;
    shown_.update(loaded_, request);
    EXPECT_FALSE(shown_.follows());
    request.apart = {1};  // it is about to be moved
    shown_.update(loaded_, request);
    EXPECT_TRUE(shown_.follows());
    EXPECT_TRUE(shown_.scene()->instances[1].apart);
    const PosedFrom from = shown_.from();
    request.instances.set_shift(1, {{0, 2, 0}, {}, {1, 1, 1}});
    shown_.update(loaded_, request);
    EXPECT_TRUE(shown_.from() == from) << "so that it is a refit";
    ASSERT_EQ(shown_.geometry().instances.size(), 2u);
    EXPECT_EQ(shown_.geometry().instances[1].world_from_object[7], 2);
    EXPECT_TRUE(shown_.scene()->positions.shares(loaded_->scene->positions));
    request.instances = {};
    request.apart.clear();
    shown_.update(loaded_, request);
    EXPECT_TRUE(shown_.from() == from) << "and so is undo";
    EXPECT_EQ(shown_.scene()->instances[1].world_from_object[7], 0);
    // In a pose, too.
    request.pose = {0.5, "all"};
    request.instances.set_shift(0, {{0, 3, 0}, {}, {1, 1, 1}});
    shown_.update(loaded_, request);
    EXPECT_EQ(shown_.scene()->instances[0].world_from_object[3], 5);
    EXPECT_EQ(shown_.scene()->instances[0].world_from_object[7], 3);
    EXPECT_FALSE(shown_.from() == from) << "another instance moves";
}

}  // namespace
}  // namespace clarity::ui
