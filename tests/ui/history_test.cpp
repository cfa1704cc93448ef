// Undo and redo: each gesture is one step, not each frame; camera motion is no step.
#include "ui/session/history.hpp"

#include <gtest/gtest.h>

namespace clarity::ui {
namespace {

TEST(History, UndoesAndRedoes) {
    History history;
    DesiredState desired;
    desired.main.settings.accel = "bvh8";
    history.observe(desired, false);
    EXPECT_FALSE(history.can_undo());
    desired.main.settings.depth = 3;
    history.observe(desired, false);
    desired.main.settings.accel = "spheres";
    history.observe(desired, false);
    EXPECT_EQ(history.undo_name(), "Structure");
    history.undo(desired);
    EXPECT_EQ(desired.main.settings.accel, "bvh8");
    EXPECT_EQ(desired.main.settings.depth, 3);
    EXPECT_EQ(history.undo_name(), "Depth");
    EXPECT_EQ(history.redo_name(), "Structure");
    history.undo(desired);
    EXPECT_EQ(desired.main.settings.depth, Settings().depth);
    EXPECT_FALSE(history.can_undo());
    history.undo(desired);  // nothing happens
    history.redo(desired);
    history.redo(desired);
    EXPECT_EQ(desired.main.settings.accel, "spheres");
    EXPECT_FALSE(history.can_redo());
}

TEST(History, AGestureIsOneStep) {
    History history;
    DesiredState desired;
    history.observe(desired, false);
    for (int depth = 1; depth <= 16; ++depth) {
        desired.main.settings.depth = depth;
        history.observe(desired, true);
    }
    EXPECT_FALSE(history.can_undo());
    history.observe(desired, false);
    history.undo(desired);
    EXPECT_EQ(desired.main.settings.depth, Settings().depth);
    EXPECT_FALSE(history.can_undo());
}

TEST(History, UndoDuringAGestureUndoesAllOfIt) {
    History history;
    DesiredState desired;
    history.observe(desired, false);
    desired.background = {1, 0, 0};
    history.observe(desired, true);
    history.undo(desired);
    EXPECT_EQ(desired.background, DesiredState().background);
    history.redo(desired);
    EXPECT_EQ(desired.background[0], 1);
}

TEST(History, UndoDoesNotMoveTheCamera) {
    History history;
    DesiredState desired;
    history.observe(desired, false);
    desired.instances.hidden = {4};
    history.observe(desired, false);
    desired.camera.eye = {1, 2, 3};
    history.observe(desired, false);
    EXPECT_EQ(history.undo_name(), "Visibility");
    history.undo(desired);
    EXPECT_TRUE(desired.instances.hidden.empty());
    EXPECT_EQ(desired.camera.eye[2], 3);
}

TEST(History, AMaskIsAStep) {
    History history;
    DesiredState desired;
    history.observe(desired, false);
    desired.instances.set_mask(4, RT_SEEN_BY_ALL & ~RT_SEEN_BY_CAMERA);
    history.observe(desired, false);
    EXPECT_EQ(history.undo_name(), "Mask");
    history.undo(desired);
    EXPECT_TRUE(desired.instances.empty());
}

TEST(History, ANewChangeDiscardsRedo) {
    History history;
    DesiredState desired;
    history.observe(desired, false);
    desired.main.settings.depth = 2;
    history.observe(desired, false);
    history.undo(desired);
    desired.main.settings.spp = 9;
    history.observe(desired, false);
    EXPECT_FALSE(history.can_redo());
    EXPECT_EQ(history.undo_name(), "Samples");
    history.forget();
    EXPECT_FALSE(history.can_undo());
}

TEST(History, NamesWhatDiffers) {
    DesiredState a, b;
    EXPECT_EQ(difference_name(a, b), "");
    b.camera.eye = {9, 9, 9};
    EXPECT_EQ(difference_name(a, b), "");
    b.other = b.main;
    EXPECT_EQ(difference_name(a, b), "Comparison");
    a.other = a.main;
    b.other->settings.depth = 1;
    EXPECT_EQ(difference_name(a, b), "B: Depth");
    b.lights.push_back({"lamp", {}, true});
    b.ambient = {1, 1, 1};
    EXPECT_EQ(difference_name(a, b), "3 changes");
    a.lights = b.lights;
    a.lights[0].on = false;
    a.ambient = b.ambient;
    a.other = b.other;
    EXPECT_EQ(difference_name(a, b), "lamp");
}

}  // namespace
}  // namespace clarity::ui
