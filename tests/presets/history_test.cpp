// Undo and redo: steps are gestures, not frames; the camera is no step.
#include "ui/history.hpp"

#include <gtest/gtest.h>

namespace clarity {
namespace {

TEST(History, TakesBackAndDoesAgain) {
    History history;
    Wish wish;
    history.observe(wish, false);
    EXPECT_FALSE(history.can_undo());
    wish.main.settings.depth = 3;
    history.observe(wish, false);
    wish.main.settings.accel = "spheres";
    history.observe(wish, false);
    EXPECT_EQ(history.undo_name(), "Structure");
    history.undo(wish);
    EXPECT_EQ(wish.main.settings.accel, "bvh8");
    EXPECT_EQ(wish.main.settings.depth, 3);
    EXPECT_EQ(history.undo_name(), "Depth");
    EXPECT_EQ(history.redo_name(), "Structure");
    history.undo(wish);
    EXPECT_EQ(wish.main.settings.depth, Settings().depth);
    EXPECT_FALSE(history.can_undo());
    history.undo(wish);  // nothing happens
    history.redo(wish);
    history.redo(wish);
    EXPECT_EQ(wish.main.settings.accel, "spheres");
    EXPECT_FALSE(history.can_redo());
}

TEST(History, AGestureIsOneStep) {
    History history;
    Wish wish;
    history.observe(wish, false);
    for (int depth = 1; depth <= 16; ++depth) {
        wish.main.settings.depth = depth;
        history.observe(wish, true);
    }
    EXPECT_FALSE(history.can_undo());
    history.observe(wish, false);
    history.undo(wish);
    EXPECT_EQ(wish.main.settings.depth, Settings().depth);
    EXPECT_FALSE(history.can_undo());
}

TEST(History, UndoInTheMiddleOfAGestureTakesItBackWhole) {
    History history;
    Wish wish;
    history.observe(wish, false);
    wish.background = {1, 0, 0};
    history.observe(wish, true);
    history.undo(wish);
    EXPECT_EQ(wish.background, Wish().background);
    history.redo(wish);
    EXPECT_EQ(wish.background[0], 1);
}

TEST(History, TheCameraStaysWhereItIs) {
    History history;
    Wish wish;
    history.observe(wish, false);
    wish.hidden = {4};
    history.observe(wish, false);
    wish.camera.eye = {1, 2, 3};
    history.observe(wish, false);
    EXPECT_EQ(history.undo_name(), "Visibility");
    history.undo(wish);
    EXPECT_TRUE(wish.hidden.empty());
    EXPECT_EQ(wish.camera.eye[2], 3);
}

TEST(History, ANewChangeForgetsWhatWasTakenBack) {
    History history;
    Wish wish;
    history.observe(wish, false);
    wish.main.settings.depth = 2;
    history.observe(wish, false);
    history.undo(wish);
    wish.main.settings.spp = 9;
    history.observe(wish, false);
    EXPECT_FALSE(history.can_redo());
    EXPECT_EQ(history.undo_name(), "Samples");
    history.forget();
    EXPECT_FALSE(history.can_undo());
}

TEST(History, NamesWhatDiffers) {
    Wish a, b;
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
}  // namespace clarity
